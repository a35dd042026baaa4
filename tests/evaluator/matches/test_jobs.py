"""What an evaluation compiles beforehand."""

from pathlib import Path
from typing import Any

import pytest
from tests.evaluator.small_matches import NAVIGATION

from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.jobs import REPLAYED, Job, cores_of, sensors_read
from wildscav_evaluator.sandbox import Limits
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server.hosting.manifest import Manifest


def job(name: str, sensors: dict[str, dict[str, object]], spec: MatchSpec = NAVIGATION, **others: Any) -> Job:
    manifest = Manifest(
        name=name, version="1", entry_point="agent:Agent", tracks=("navigation",), sensors=sensors
    )
    submission = Submission(Path("/") / name, manifest, digest="0" * 32)
    return Job.of_one(submission, spec.track, 0, spec, Path("/out"), **{"replay": False} | others)


def test_only_sensors_that_submissions_ask_for_are_compiled_beforehand() -> None:
    one, other = job("one", {"lidar": {"channels": 4}}), job("other", {})
    assert sensors_read([one, one, other]) == [{"lidar": {"channels": 4}}, {}]


def test_replays_need_the_cameras_that_they_show() -> None:
    assert sensors_read([job("one", {}, replay=True)]) == [{}, REPLAYED]


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
def test_a_match_reserves_the_cores_that_its_agents_may_use_at_the_same_time(
    seats: tuple[str, ...], cpus: float, largest: int, cores: int
) -> None:
    of_battle = job("one", {}, MatchSpec(track="battle", seats=seats), limits=Limits(cpus=cpus))

    assert cores_of(of_battle, largest) == cores
