"""A submission in several seats of one match, and what spectators see of it while it runs."""

import asyncio
import shutil
from pathlib import Path

import numpy as np
import pytest
from tests.evaluator.conftest import submission_in
from tests.evaluator.sample_agents import Submit
from tests.evaluator.small_matches import SMALL, job_of

from wildscav_engine.record import read_record, resimulate
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.jobs import Heartbeat, Job, JobEvent, JobResult
from wildscav_evaluator.matches.run_job import run_job
from wildscav_evaluator.matches.snapshots import Happenings, WatchedMatch
from wildscav_evaluator.matches.watchdog import ProgressTimeouts, Watchdog
from wildscav_evaluator.output.folder import keep_only
from wildscav_evaluator.output.layout import LOGS
from wildscav_evaluator.sandbox import Limits
from wildscav_evaluator.scores.rescore import read_file, recompute, replay_file
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


@pytest.fixture(scope="module")
def twins(tmp_path_factory: pytest.TempPathFactory) -> JobResult:
    place, seats = tmp_path_factory.mktemp("twins"), ("walker", "submission", "walker", "submission")
    spec = MatchSpec(track="navigation", map=SMALL, seats=seats, time_limit=STEPS / 10)
    limits = Limits.model_validate({"output": 4096})
    job = job_of(submission_in(place, "twins", TWINS), place / "out", spec=spec, limits=limits)
    with asyncio.Runner() as runner:
        return run_job(runner, job)


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
    replayed = replay_file(read_file(twins.job.out / str(twins.row.record)))

    assert replayed.fault == ""
    assert replayed.metrics == twins.row.metrics
    ((row,),) = (one.matches for one in recompute([replayed], None))
    assert [(seat.seat, seat.metrics) for seat in row.seats] == [
        (seat.seat, seat.metrics) for seat in twins.row.seats
    ]


def test_logs_of_seats_are_kept_with_their_match(twins: JobResult, tmp_path: Path) -> None:
    out = shutil.copytree(twins.job.out, tmp_path / "out")
    keep_only(out, [twins.job.stem])
    assert (out / twins.job.record).exists()
    assert all((out / log).exists() for log in twins.row.logs)

    keep_only(out, [])
    assert list((out / LOGS).iterdir()) == []


# Takes its time, so that a match lasts for several heartbeats.
SLOW = """
    def act(self, observation):
        import time
        time.sleep(0.05)
        return Action(walk_direction=90.0, walk_speed=8.0)
"""


SPEC = MatchSpec(track="battle", map=SMALL, seats=("submission", "fighter"), time_limit=4.0)


def heartbeats_of(submission: Submission, out: Path, watched: bool) -> tuple[Job, list[Heartbeat]]:
    """Play a match, and return what it reported."""
    events: list[JobEvent] = []
    job = job_of(submission, out, spec=SPEC, watched=watched)
    with asyncio.Runner() as runner:
        result = run_job(runner, job, events.append)
    assert result.row.status == "finished", result.row.detail
    return job, [event for event in events if isinstance(event, Heartbeat)]


def test_snapshots_are_the_moments_of_the_record(submit: Submit, tmp_path: Path) -> None:
    job, heartbeats = heartbeats_of(submit("slow", SLOW), tmp_path / "out", watched=True)
    snapshots = [snapshot for heartbeat in heartbeats for snapshot in heartbeat.snapshots]
    record = read_record(job.out / job.record)

    frames = [snapshot.frame for snapshot in snapshots]
    moments = {match.frame: Happenings(match).take().seats for match in resimulate(record)}

    assert len(snapshots) > 3
    assert frames == sorted(set(frames))
    assert frames[-1] == max(moments)
    assert all(snapshot.seats == moments[snapshot.frame] for snapshot in snapshots)
    assert [snapshot.first for snapshot in snapshots] == [True] + [False] * (len(snapshots) - 1)


def test_a_match_that_nobody_watches_sends_none(submit: Submit, tmp_path: Path) -> None:
    _, heartbeats = heartbeats_of(submit("slow", SLOW), tmp_path / "out", watched=False)

    assert len(heartbeats) > 1
    assert all(heartbeat.snapshots == () for heartbeat in heartbeats)


def test_snapshots_are_in_centimetres() -> None:
    match = Match(MatchSpec(track="navigation", map=SMALL, seats=("walker",), time_limit=2.0))
    match.play_out()
    snapshot, agents = Happenings(match).take(), match.state.agents
    seat = snapshot.seats[0]

    there = np.array([seat.x, seat.height, seat.z]) / 100
    np.testing.assert_allclose(there, agents.position[0, 0], atol=0.00501)
    assert (seat.yaw, seat.pitch) == (round(agents.yaw[0, 0]), round(agents.pitch[0, 0]))
    assert snapshot.target is not None
    np.testing.assert_allclose(np.array(snapshot.target) / 100, match.state.matches.target[0], atol=0.00501)
    assert (seat.health, snapshot.happened) == (100, ())


def test_what_happens_between_two_snapshots_is_in_the_later_one() -> None:
    match = WatchedMatch(SPEC)
    match.happenings.take()
    agents = match.state.agents
    match.step()
    agents.fired[0, 1], agents.hit_seat[0, 1], agents.shot_end[0, 1] = True, 0, (1.0, 2.5, -3.0)
    agents.health[0, 0] = 80
    match.happenings.note()
    match.step()

    snapshot = match.happenings.take()

    assert snapshot.happened[0] == (5, "hit", 1, 0, 80)
    assert snapshot.shots == ((5, 1, 100, 250, -300),)
    assert match.happenings.take().shots == ()


def test_a_watched_match_that_stands_still_is_noticed(submit: Submit, tmp_path: Path) -> None:
    job = job_of(submit("slow", SLOW), tmp_path, spec=SPEC, watched=True)
    watchdog = Watchdog(job, ProgressTimeouts(step=1.0))
    moment = Happenings(Match(SPEC)).take()
    watchdog.hear(Heartbeat(5, 1, (moment,)))
    for _ in range(100):
        watchdog.hear(Heartbeat(5, 1))  # it lives, and nothing goes on
        watchdog.wait(2.0)

    assert "after step 1" in watchdog.verdict
