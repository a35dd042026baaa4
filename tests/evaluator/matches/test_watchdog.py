"""How long a job may get no further before its worker counts as hung."""

from pathlib import Path

import pytest
from tests.evaluator.sample_agents import WALKER, Submit

from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.jobs import AttemptFailed, Heartbeat, Job, JobEvent, RenderingReplay
from wildscav_evaluator.matches.watchdog import CHECK_INTERVAL, ProgressTimeouts, Watchdog

TIMEOUTS = ProgressTimeouts(set_up=300.0, seat=30.0, step=90.0, rendering=300.0)


@pytest.fixture
def job(submit: Submit, tmp_path: Path) -> Job:
    spec = MatchSpec(track="battle", seats=("submission", "submission", "fighter"), time_limit=600.0)
    return Job.of_one(submit("walker", WALKER), "battle", 0, spec, tmp_path, replay=True)


def wait(watchdog: Watchdog, seconds: float) -> str:
    for _ in range(round(seconds / CHECK_INTERVAL)):
        watchdog.wait(CHECK_INTERVAL)
    return watchdog.verdict


@pytest.mark.parametrize(
    ("told", "limit", "where"),
    [
        # To make its map and start two agents.
        ([], 360, "before the first step"),
        ([Heartbeat(0, 0)], 360, "before the first step"),
        ([Heartbeat(500, 100), AttemptFailed("no memory")], 360, "before the first step"),
        # 0.1 s for a step, as much that may be credited, and 30 s of bank.
        ([Heartbeat(500, 1_100)], 120, "after step 1,100"),
        # A match of ten minutes.
        ([Heartbeat(500, 100), RenderingReplay()], 900, "while it rendered the replay"),
    ],
)
def test_the_limit_follows_from_what_the_job_is_at(
    job: Job, told: list[JobEvent], limit: int, where: str
) -> None:
    watchdog = Watchdog(job, TIMEOUTS)
    for one in told:
        watchdog.hear(one)

    assert wait(watchdog, limit) == ""
    assert wait(watchdog, 1.0) == f"the worker process hung: no progress in {limit} s {where}"


def test_progress_begins_the_time_anew_and_signs_of_life_alone_do_not(job: Job) -> None:
    watchdog = Watchdog(job, TIMEOUTS)
    for step in range(1, 4):
        watchdog.hear(Heartbeat(5 * step, step))
        assert wait(watchdog, 100.0) == ""

    watchdog.hear(Heartbeat(15, 3))

    assert wait(watchdog, 30.0) != ""


def test_time_in_which_all_was_stopped_does_not_count(job: Job) -> None:
    watchdog = Watchdog(job, TIMEOUTS)

    watchdog.wait(10_000.0)

    assert watchdog.verdict == ""
