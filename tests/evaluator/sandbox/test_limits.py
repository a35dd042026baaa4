"""Limits come from the suite's track to the agent."""

from pathlib import Path

import pytest
from pydantic import ValidationError

from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.jobs import Job
from wildscav_evaluator.matches.play import launch_for
from wildscav_evaluator.sandbox import Limits
from wildscav_evaluator.submissions.submission import load_submission

REPOSITORY = Path(__file__).parents[3]
TIGHT = Limits(memory="512MiB", processes=20)  # type: ignore[arg-type]


def test_a_jobs_limits_are_those_of_its_agents(tmp_path: Path) -> None:
    submission = load_submission(REPOSITORY / "submissions" / "random")
    spec = MatchSpec(track="navigation", map=MapSpec(config=MapConfig(size=40, houses=1), seed=3))

    seating = Job.of_one(submission, "navigation", 0, spec, tmp_path, replay=False, limits=TIGHT).seating

    assert seating.limits == TIGHT
    assert launch_for(submission, "unix:/nowhere", "token", tmp_path / "log", seating.limits).limits == TIGHT


@pytest.mark.parametrize(
    "wrong",
    [{"cpus": 0}, {"memory": "1 MiB"}, {"processes": 1}, {"wall_clock": -1}, {"memory": "much"}, {"disk": 1}],
)
def test_limits_that_nobody_could_live_under_are_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        Limits.model_validate(wrong)
