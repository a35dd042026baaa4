"""A match that was played on a node is written here like one that was played here."""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.evaluator.interrupted_runs import contents
from tests.evaluator.sample_agents import TALKER, Submit
from tests.evaluator.small_matches import job_of
from tests.evaluator.warm_workers import WarmWorkers

from wildscav_evaluator.executors.cluster.messages import Played
from wildscav_evaluator.executors.ray_executor import saved
from wildscav_evaluator.matches.jobs import Job
from wildscav_evaluator.output.layout import LOGS, RECORDS


@pytest.fixture
def job(submit: Submit, tmp_path: Path) -> Job:
    return job_of(submit("talker", TALKER), tmp_path / "out")


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
