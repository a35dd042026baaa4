"""What a node of a cluster needs to play, what is sent to it, and what it sends back."""

import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from tests.evaluator.executors.match_files import contents
from tests.evaluator.sample_agents import TALKER, WALKER, Submit
from tests.evaluator.warm_workers import WarmWorkers

from wildscav.errors import UserError
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.executors.cluster import submission_archives
from wildscav_evaluator.executors.cluster.match_host import Broken, MatchHost, Shipment
from wildscav_evaluator.executors.cluster.messages import Played
from wildscav_evaluator.executors.cluster.node_examination import code_digest, examine, mismatch
from wildscav_evaluator.executors.cluster.submission_archives import arrived, pack
from wildscav_evaluator.executors.ray_executor import saved
from wildscav_evaluator.matches.jobs import Heartbeat, Job, cores_of
from wildscav_evaluator.output.layout import LOGS, RECORDS, REPLAYS
from wildscav_evaluator.output.results import CURRENT_VERSIONS
from wildscav_evaluator.sandbox import Limits
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_server import leftovers
from wildscav_server.hosting.manifest import SubmissionError

VERSIONS = CURRENT_VERSIONS.model_dump()


@pytest.mark.parametrize(
    ("versions", "code", "difference"),
    [
        (VERSIONS, code_digest(), ""),
        (
            VERSIONS,
            "0" * 16,
            "its Wildscav has the same version, but other code: install the same files there",
        ),
        (
            {**VERSIONS, "simulation": 999},
            "0" * 16,  # of course
            f"it has another version of Wildscav: simulation 999 instead of {VERSIONS['simulation']}",
        ),
        (
            {name: version for name, version in VERSIONS.items() if name != "simulation"},
            code_digest(),
            f"it has another version of Wildscav: simulation None instead of {VERSIONS['simulation']}",
        ),
    ],
)
def test_differences(versions: dict[str, object], code: str, difference: str) -> None:
    assert mismatch({"versions": versions, "code": code}) == difference


def test_this_machine_may_play_with_itself_but_lacks_a_sandbox_that_nobody_knows() -> None:
    found = examine(["process", "vault"], [])

    assert mismatch(found) == ""
    assert found["sandboxes"]["vault"] == "there is no sandbox vault there"
    assert found["images"] == {}


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


@pytest.fixture
def folder(submit: Submit, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A submission with all that a folder may have."""
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", str(tmp_path / "node's cache"))
    folder = submit("walker", WALKER).folder
    (folder / "weights" / "empty").mkdir(parents=True)
    (folder / "weights" / "large.bin").write_bytes(bytes(range(256)) * 1000)
    (folder / "current").symlink_to("weights/large.bin")
    (folder / "play.sh").write_text("#!/bin/sh\n")
    (folder / "play.sh").chmod(0o755)
    (folder / "__pycache__").mkdir()
    (folder / "__pycache__" / "agent.pyc").touch()
    return folder


def test_a_submission_arrives_with_the_same_digest_and_all_of_its_files(folder: Path) -> None:
    sent = load_submission(folder)

    there = arrived(pack(folder), sent.digest)

    assert load_submission(there).digest == sent.digest
    assert (there / "current").read_bytes() == (there / "weights" / "large.bin").read_bytes()
    assert not (there / "current").is_symlink()
    assert (there / "play.sh").stat().st_mode & 0o100
    assert not (there / "__pycache__").exists()
    assert there.stat().st_mode & 0o005 == 0o005  # agents run as another user


def test_a_submission_is_packed_into_the_same_bytes_whenever_it_was_written(folder: Path) -> None:
    before = pack(folder)
    (folder / "play.sh").touch()
    assert pack(folder) == before


def test_a_copy_that_was_changed_on_the_node_is_not_used_again(folder: Path) -> None:
    digest = load_submission(folder).digest
    first = arrived(pack(folder), digest)
    assert arrived(pack(folder), digest) == first
    (first / "agent.py").write_text("something else")

    again = arrived(pack(folder), digest)

    assert again != first
    assert load_submission(again).digest == digest


def test_another_submission_than_expected_is_refused(folder: Path) -> None:
    with pytest.raises(SubmissionError, match="arrived with other content"):
        arrived(pack(folder), "0" * 32)


def test_a_submission_that_is_too_large_to_send_is_refused(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(submission_archives, "LARGEST_CONTENT", 100_000)
    with pytest.raises(UserError, match="build an image of it on every node"):
        pack(folder)


@pytest.fixture
def job(submit: Submit, tmp_path: Path) -> Job:
    for name in (RECORDS, REPLAYS, LOGS):
        (tmp_path / "out" / name).mkdir(parents=True)
    spec = MatchSpec(track="navigation", map=MapSpec(config=MapConfig(size=40, houses=0)), time_limit=1.0)
    return Job.of_one(submit("talker", TALKER), "navigation", 0, spec, tmp_path / "out", replay=False)


def test_the_files_of_a_match_are_those_of_a_local_worker(
    warm_workers: WarmWorkers, job: Job, tmp_path: Path
) -> None:
    (here,) = warm_workers.run([job])
    expected = contents(job.out)
    for path in job.out.rglob("*.*"):
        path.unlink()
    files = {name: content for name, content in expected.items() if isinstance(content, bytes)}

    result = saved(job, Played(here.row, here.timing, "", files))

    assert contents(job.out) == expected
    assert result == here
    assert {path.parent.name for path in job.out.rglob("*.*")} == {RECORDS, LOGS}


def test_a_record_that_cannot_be_written_costs_its_match_alone(warm_workers: WarmWorkers, job: Job) -> None:
    (here,) = warm_workers.run([job])
    files = {job.record: (job.out / job.record).read_bytes()}
    other = replace(job, index=1)
    (other.out / other.record).mkdir()
    row = here.row.model_copy(update={"record": other.record})

    lost = saved(other, Played(row, here.timing, "", {other.record: files[job.record]}))

    assert (lost.row.status, lost.row.fault) == ("failed", "platform")
    assert str(other.out / other.record) in lost.row.detail
    assert (other.out / other.record).is_dir()


SPEC = MatchSpec(track="navigation", map=MapSpec(config=MapConfig(size=40, houses=0)), time_limit=1.0)


@pytest.fixture(scope="module")
def host() -> Iterator[MatchHost]:
    main = vars(sys.modules["__main__"])
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(main, "__file__", main.get("__file__", ""))  # the host takes it away
        patch.setenv("OMP_NUM_THREADS", "1")
        host = MatchHost([])
        yield host
        host.stop()


def end_of(host: MatchHost, job: Job, files: dict[str, bytes]) -> Played | Broken:
    """Play a match of a submission that this node has, until its end."""
    digest = job.submissions[0].digest
    host._arrived[digest] = job.submissions[0].folder
    report = host.play(job, {job.submissions[0].folder: Shipment(digest, None)}, files)
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
    digest = job.submissions[0].digest
    host._arrived[digest] = job.submissions[0].folder
    host.prepare()

    reports = [host.play(job, {job.submissions[0].folder: Shipment(digest, None)}, {})]
    while reports[-1].end is None:
        reports.append(host.report())

    # The match lasts for less than the longest time between two reports, and has two heartbeats and more.
    carrying = [
        sum(isinstance(event, Heartbeat) and bool(event.snapshots) for event in report.events)
        for report in reports
    ]
    assert max(carrying) == 1
    assert sum(carrying) >= 2
