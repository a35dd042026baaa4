"""The actor of a node plays matches as this machine does; here it stands in the test's own process."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import TALKER, Submit
from tests.evaluator.small_matches import NAVIGATION

from wildscav_evaluator.executors.cluster.match_host import Broken, MatchHost, Report, Shipment
from wildscav_evaluator.executors.cluster.messages import Played
from wildscav_evaluator.matches.jobs import Heartbeat, Job
from wildscav_server import leftovers

SPEC = NAVIGATION.model_copy(update={"time_limit": 1.0})


@pytest.fixture(scope="module")
def host() -> Iterator[MatchHost]:
    main = vars(sys.modules["__main__"])
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(main, "__file__", main.get("__file__", ""))  # the host takes it away
        patch.setenv("OMP_NUM_THREADS", "1")
        host = MatchHost([])
        yield host
        host.stop()


def begin(host: MatchHost, job: Job, files: dict[str, bytes]) -> Report:
    """Begin a match of a submission that this node has."""
    (submission,) = job.submissions
    host._arrived[submission.digest] = submission.folder
    return host.play(job, {submission.folder: Shipment(submission.digest, None)}, files)


def end_of(host: MatchHost, job: Job, files: dict[str, bytes]) -> Played | Broken:
    """Play a match until its end."""
    report = begin(host, job, files)
    while report.end is None:
        report = host.report()
    return report.end


@pytest.mark.slow
def test_a_match_ends_with_its_files_and_nothing_of_it_is_left_on_the_node(
    host: MatchHost, submit: Submit, tmp_path: Path
) -> None:
    job = Job.of_one(submit("talker", TALKER), "navigation", 0, SPEC, tmp_path / "not here", replay=False)
    host.prepare()
    before = set(leftovers.own_folder().iterdir())

    end = end_of(host, job, {})

    assert isinstance(end, Played)
    assert end.row.status == "finished"
    assert set(end.files) == {job.record, job.log(0)}
    assert end.files[job.log(0)].startswith(b"step 0\nstep 1\n")
    assert set(leftovers.own_folder().iterdir()) == before
    assert not job.out.exists()


def test_a_file_that_cannot_be_written_breaks_its_attempt_alone(
    host: MatchHost, submit: Submit, tmp_path: Path
) -> None:
    job = Job.of_one(submit("walker", ""), "navigation", 0, SPEC, tmp_path, replay=False)

    end = end_of(host, job, {"no folder/file": b""})

    assert isinstance(end, Broken)
    assert "No such file or directory" in end.reason
    with pytest.raises(RuntimeError, match="no match is being played"):
        MatchHost([]).report()


def test_spectators_of_a_match_get_each_heartbeat_at_once(
    host: MatchHost, submit: Submit, tmp_path: Path
) -> None:
    slow = """
    def act(self, observation):
        import time
        time.sleep(0.1)
        return Action()
"""
    job = Job.of_one(submit("slow", slow), "navigation", 0, SPEC, tmp_path / "not here", False, watched=True)
    host.prepare()

    reports = [begin(host, job, {})]
    while reports[-1].end is None:
        reports.append(host.report())

    # The match lasts for less than the longest time between two reports, and has two heartbeats and more.
    carrying = [
        sum(isinstance(event, Heartbeat) and bool(event.snapshots) for event in report.events)
        for report in reports
    ]
    assert max(carrying) == 1
    assert sum(carrying) >= 2
