"""A submission in several seats of one match: each seat has a log, an outcome and a clock of its own."""

import asyncio
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import WALKER, Submit

from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.jobs import Job, JobResult
from wildscav_evaluator.matches.run_job import run_job
from wildscav_evaluator.output.folder import keep_only
from wildscav_evaluator.output.layout import LOGS, RECORDS
from wildscav_evaluator.sandbox import Limits
from wildscav_evaluator.scores.rescore import recompute, replay_one
from wildscav_evaluator.submissions.submission import Submission

pytestmark = pytest.mark.usefixtures("compiled")

STEPS = 20
# Talks more than is kept in seat 1, falls there in the middle of the match, and says little in seat 3.
TWINS = """
    def reset(self, match):
        self.seat = match.seat

    def act(self, observation):
        if self.seat == 1:
            print("x" * 1000)
        if self.seat == 1 and observation.step == 10:
            raise RuntimeError("lost the thread in seat 1")
        if observation.step == 0:
            print("this is seat", self.seat)
        return Action(walk_direction=90.0 * self.seat, walk_speed=8.0)
"""
LIMITS = Limits(output=4096)  # type: ignore[arg-type]


def play(submission: Submission, out: Path, seats: tuple[str, ...]) -> JobResult:
    for name in (RECORDS, LOGS):
        (out / name).mkdir(parents=True)
    small = MapSpec(config=MapConfig(size=40, houses=0), seed=3)
    spec = MatchSpec(track="navigation", map=small, seats=seats, time_limit=STEPS / 10)
    with asyncio.Runner() as runner:
        return run_job(
            runner,
            Job.of_one(submission, "navigation", 0, spec, out, False, limits=LIMITS),
        )


@pytest.fixture
def twins(submit: Submit, tmp_path: Path) -> JobResult:
    seats = ("walker", "submission", "walker", "submission")
    return play(submit("twins", TWINS), tmp_path / "out", seats)


def test_each_seat_has_a_log_of_its_own_which_is_cut_alone(twins: JobResult) -> None:
    out = twins.job.out
    first, other = twins.row.seats

    assert twins.row.logs == ("logs/navigation-000-twins.seat-1.log", "logs/navigation-000-twins.seat-3.log")
    loud = (out / str(first.log)).read_text()
    assert 4096 <= len(loud) < 4200
    assert loud.endswith("[the log is cut here]\n")
    assert (out / str(other.log)).read_text() == "this is seat 3\n"


def test_each_seat_has_an_outcome_last_lines_and_a_clock_of_its_own(twins: JobResult) -> None:
    row, timing = twins.row, twins.timing
    first, other = row.seats
    assert timing is not None

    assert (first.seat, first.status, first.fault, first.exit_code) == (1, "crashed", "agent", 3)
    assert first.last_lines[-1] == "RuntimeError: lost the thread in seat 1"
    assert (other.seat, other.status, other.fault, other.last_lines) == (3, "finished", None, ())
    assert [(one.seat, one.steps) for one in timing.seats] == [(1, 10), (3, STEPS)]
    for one in timing.seats:
        assert 0.0 < one.latency_p50 <= one.latency_p99 <= one.latency_max <= one.time_used
        assert one.start_up is not None
        assert one.time_bank > 0.0


def test_a_match_went_wrong_if_one_of_its_seats_did_and_scores_their_mean(twins: JobResult) -> None:
    row = twins.row
    first, other = row.seats

    assert (row.status, row.fault, row.detail) == (first.status, first.fault, first.detail)
    assert first.metrics["time"] != other.metrics["time"]
    assert row.metrics == {name: (first.metrics[name] + other.metrics[name]) / 2 for name in first.metrics}


def test_a_record_bears_out_every_seat(twins: JobResult) -> None:
    replayed = replay_one(twins.job.out / str(twins.row.record))

    assert replayed.fault == ""
    assert replayed.metrics == twins.row.metrics
    ((row,),) = (one.matches for one in recompute([replayed], None))
    assert [(seat.seat, seat.metrics) for seat in row.seats] == [
        (seat.seat, seat.metrics) for seat in twins.row.seats
    ]


def test_logs_of_seats_are_kept_with_their_match(twins: JobResult) -> None:
    keep_only(twins.job.out, [twins.job.stem])
    assert (twins.job.out / twins.job.record).exists()
    assert all((twins.job.out / log).exists() for log in twins.row.logs)

    keep_only(twins.job.out, [])
    assert list((twins.job.out / LOGS).iterdir()) == []


def test_a_submission_in_one_seat_has_one_log_and_its_own_metrics(submit: Submit, tmp_path: Path) -> None:
    result = play(submit("walker", WALKER + "\nprint('here')"), tmp_path / "out", ("submission", "walker"))

    (seat,) = result.row.seats
    assert seat.log == "logs/navigation-000-walker.log"
    assert result.row.metrics == seat.metrics
