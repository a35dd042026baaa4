"""A match reserves a core for every core that its agents may use at the same time."""

from pathlib import Path

import pytest
from tests.evaluator.sample_agents import WALKER, Submit

from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.jobs import Job, cores_of
from wildscav_evaluator.sandbox import Limits


@pytest.mark.parametrize(
    ("seats", "cpus", "largest", "cores"),
    [
        (("submission", "fighter"), 1.0, 64, 1),  # robots play inside the server
        (("submission",) * 10, 1.0, 64, 10),
        (("submission",) * 10, 1.0, 4, 4),  # no node has ten: a whole node
        (("submission",) * 3, 0.5, 64, 2),  # whole cores
        (("submission",), 0.25, 64, 1),
        (("submission",), 4.0, 64, 4),  # a suite that grants four
        (("fighter", "fighter"), 1.0, 64, 1),  # a match of robots alone
    ],
)
def test_cores(
    submit: Submit, tmp_path: Path, seats: tuple[str, ...], cpus: float, largest: int, cores: int
) -> None:
    spec = MatchSpec(track="battle", seats=seats)
    job = Job.of_one(
        submit("walker", WALKER), "battle", 0, spec, tmp_path, replay=False, limits=Limits(cpus=cpus)
    )

    assert cores_of(job, largest) == cores
