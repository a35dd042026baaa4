"""What spectators see of a running match: snapshots in the heartbeats, compared with the record."""

import asyncio
from pathlib import Path

import numpy as np
import pytest
from tests.evaluator.sample_agents import Submit

from wildscav_engine.record import read_record, resimulate
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.jobs import Heartbeat, Job, JobEvent
from wildscav_evaluator.matches.run_job import run_job
from wildscav_evaluator.matches.snapshots import Notes, WatchedMatch
from wildscav_evaluator.matches.watchdog import ProgressTimeouts, Watchdog
from wildscav_evaluator.output.layout import LOGS, RECORDS
from wildscav_evaluator.submissions.submission import Submission

pytestmark = pytest.mark.usefixtures("compiled")

# Takes its time, so that a match lasts for several heartbeats.
SLOW = """
    def act(self, observation):
        import time
        time.sleep(0.05)
        return Action(walk_direction=90.0, walk_speed=8.0)
"""
SMALL = MapSpec(config=MapConfig(size=40, houses=0), seed=3)
SPEC = MatchSpec(track="battle", map=SMALL, seats=("submission", "fighter"), time_limit=4.0)


def heartbeats_of(submission: Submission, out: Path, watched: bool) -> tuple[Job, list[Heartbeat]]:
    """Play a match, and return what it reported."""
    for name in (RECORDS, LOGS):
        (out / name).mkdir(parents=True)
    events: list[JobEvent] = []
    job = Job.of_one(submission, "battle", 0, SPEC, out, False, watched=watched)
    with asyncio.Runner() as runner:
        result = run_job(runner, job, events.append)
    assert result.row.status == "finished", result.row.detail
    return job, [event for event in events if isinstance(event, Heartbeat)]


def test_snapshots_are_the_moments_of_the_record(submit: Submit, tmp_path: Path) -> None:
    job, heartbeats = heartbeats_of(submit("slow", SLOW), tmp_path / "out", watched=True)
    snapshots = [snapshot for heartbeat in heartbeats for snapshot in heartbeat.snapshots]
    record = read_record(job.out / job.record)

    frames = [snapshot.frame for snapshot in snapshots]
    moments = {match.frame: Notes(match).take().seats for match in resimulate(record)}

    assert len(snapshots) > 3
    assert frames == sorted(set(frames))
    assert all(snapshot.seats == moments[snapshot.frame] for snapshot in snapshots)
    assert [snapshot.first for snapshot in snapshots] == [True] + [False] * (len(snapshots) - 1)


def test_a_match_that_nobody_watches_sends_none(submit: Submit, tmp_path: Path) -> None:
    _, heartbeats = heartbeats_of(submit("slow", SLOW), tmp_path / "out", watched=False)

    assert len(heartbeats) > 1
    assert all(heartbeat.snapshots == () for heartbeat in heartbeats)


def test_snapshots_are_in_centimetres() -> None:
    match = Match(MatchSpec(track="navigation", map=SMALL, seats=("walker",), time_limit=2.0))
    match.play_out()
    snapshot, agents = Notes(match).take(), match.state.agents
    seat = snapshot.seats[0]

    there = np.array([seat.x, seat.height, seat.z]) / 100
    np.testing.assert_allclose(there, agents.position[0, 0], atol=0.00501)
    assert (seat.yaw, seat.pitch) == (round(agents.yaw[0, 0]), round(agents.pitch[0, 0]))
    assert snapshot.target is not None
    np.testing.assert_allclose(np.array(snapshot.target) / 100, match.state.matches.target[0], atol=0.00501)
    assert (seat.health, snapshot.happened) == (100, ())


def test_what_happens_between_two_snapshots_is_in_the_later_one() -> None:
    match = WatchedMatch(SPEC)
    match.notes.take()
    agents = match.state.agents
    match.step()
    agents.fired[0, 1], agents.hit_seat[0, 1], agents.shot_end[0, 1] = True, 0, (1.0, 2.5, -3.0)
    agents.health[0, 0] = 80
    match.notes.note()
    match.step()

    snapshot = match.notes.take()

    assert snapshot.happened[0] == (5, "hit", 1, 0, 80)
    assert snapshot.shots == ((5, 1, 100, 250, -300),)
    assert match.notes.take().shots == ()


def test_a_watched_match_that_stands_still_is_noticed(submit: Submit, tmp_path: Path) -> None:
    job = Job.of_one(submit("slow", SLOW), "battle", 0, SPEC, tmp_path, False, watched=True)
    watchdog = Watchdog(job, ProgressTimeouts(step=1.0))
    moment = Notes(Match(SPEC)).take()
    watchdog.hear(Heartbeat(5, 1, (moment,)))
    for _ in range(100):
        watchdog.hear(Heartbeat(5, 1))  # it lives, and nothing goes on
        watchdog.wait(2.0)

    assert "after step 1" in watchdog.verdict
