"""What an evaluation compiles beforehand."""

from pathlib import Path

from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.jobs import REPLAYED, Job, sensors_read
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server.hosting.manifest import Manifest


def job(name: str, sensors: dict[str, dict[str, object]], *, replay: bool = False) -> Job:
    manifest = Manifest(
        name=name, version="1", entry_point="agent:Agent", tracks=("navigation",), sensors=sensors
    )
    submission = Submission(Path("/") / name, manifest, digest="0" * 32)
    return Job.of_one(submission, "navigation", 0, MatchSpec(track="navigation"), Path("/out"), replay)


def test_only_sensors_that_submissions_ask_for_are_compiled_beforehand() -> None:
    one, other = job("one", {"lidar": {"channels": 4}}), job("other", {})
    assert sensors_read([one, one, other]) == [{"lidar": {"channels": 4}}, {}]


def test_replays_need_the_cameras_that_they_show() -> None:
    assert sensors_read([job("one", {}, replay=True)]) == [{}, REPLAYED]
