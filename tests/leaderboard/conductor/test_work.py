"""What the conductor keeps of a match that was played."""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.leaderboard.seasons_made import make_season

from wildscav.errors import UserError
from wildscav_engine.storage.files import write_whole
from wildscav_evaluator.matches.jobs import Job, JobResult
from wildscav_evaluator.output.journal import file_digest
from wildscav_evaluator.output.results import MatchRow
from wildscav_evaluator.sandbox.limits import DEFAULT_LIMITS
from wildscav_leaderboard.conductor.work import keep_record


@pytest.fixture
def result(tmp_path: Path) -> JobResult:
    """The result of a match whose record was written."""
    season = make_season(tmp_path / "season")
    job = Job(
        submissions=(),
        track="navigation",
        index=0,
        spec=season.suite_matches["navigation"][0],
        out=tmp_path / "match",
        replay=False,
        evaluation="match-1",
        sandbox="process",
        limits=DEFAULT_LIMITS,
        evaluated="runner-1",
    )
    path = job.out / job.record
    path.parent.mkdir(parents=True)
    path.write_bytes(b"the first record")
    return JobResult(
        job, MatchRow(index=0, status="finished", metrics={"time": 1.0}, record=job.record), None
    )


def test_a_worker_that_comes_too_late_cannot_change_a_record_that_is_kept(result: JobResult) -> None:
    row, record = keep_record(result)
    write_whole(result.job.out / result.job.record, b"another record of the same match")
    kept = result.job.out / str(row.record)
    assert row.record != result.row.record
    assert kept.read_bytes() == b"the first record"
    assert (file_digest(kept), kept.stat().st_size) == (record.digest, record.size)


def test_a_record_is_kept_once_however_often_it_comes(result: JobResult) -> None:
    first, _ = keep_record(result)
    again, record = keep_record(result)
    assert first == again
    assert file_digest(result.job.out / str(again.record)) == record.digest
    assert len(list((result.job.out / result.job.record).parent.iterdir())) == 2


def test_a_match_without_a_record_is_refused(result: JobResult) -> None:
    without = replace(result, row=result.row.model_copy(update={"record": None}))
    with pytest.raises(UserError, match="the match match-1 has no record"):
        keep_record(without)
