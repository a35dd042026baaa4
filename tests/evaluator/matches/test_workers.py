"""Workers: one that dies costs the match that it was at, and nothing else."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tests.evaluator.players import SLEEPER, WALKER, Submit

from wildscav_engine.spec import MapConfig, MapSpec, MatchSpec
from wildscav_evaluator.matches.jobs import LOGS, RECORDS, REPLAYS, Job, JobResult
from wildscav_evaluator.matches.workers import Workers
from wildscav_evaluator.output.journal import MATCHES
from wildscav_evaluator.submissions.submission import Submission

WORKER_KILLER = """
    def act(self, observation):
        os.kill(os.getppid(), signal.SIGKILL)
        time.sleep(600)
"""


@pytest.fixture
def out(tmp_path: Path) -> Path:
    for name in (RECORDS, REPLAYS, LOGS, MATCHES):
        (tmp_path / "out" / name).mkdir(parents=True)
    return tmp_path / "out"


def job(submission: Submission, index: int, out: Path) -> Job:
    spec = MatchSpec(
        track="navigation", map=MapSpec(config=MapConfig(size=40, houses=0)), seed=index, time_limit=2.0
    )
    return Job(submission, "navigation", index, spec, out, replay=False)


def run(jobs: list[Job], count: int) -> dict[tuple[str, int], JobResult]:
    with Workers(count) as workers:
        workers.warm()
        return {(result.job.submission.name, result.job.index): result for result in workers.run(jobs)}


@pytest.mark.parametrize("count", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_a_worker_that_is_killed_costs_its_match_alone(submit: Submit, out: Path, count: int) -> None:
    walker, killer = submit("walker", WALKER), submit("killer", WORKER_KILLER)
    jobs = [job(walker, 0, out), job(killer, 0, out), job(walker, 1, out), job(walker, 2, out)]

    results = run(jobs, count)

    assert len(results) == len(jobs)
    dead = results["killer", 0].row
    assert (dead.status, dead.fault, dead.metrics) == ("failed", "platform", None)
    assert "the worker process died (exit code -9)" in dead.detail
    for index in range(3):
        assert results["walker", index].row.fault is None
        assert (out / results["walker", index].job.record).exists()


def test_a_record_that_cannot_be_written_costs_its_match_alone(submit: Submit, out: Path) -> None:
    walker = submit("walker", WALKER)
    jobs = [job(walker, 0, out), job(walker, 1, out)]
    (out / jobs[0].record).mkdir()

    results = run(jobs, 1)

    lost = results["walker", 0].row
    assert (lost.status, lost.fault) == ("failed", "platform")
    assert str(out / jobs[0].record) in lost.detail
    assert results["walker", 1].row.fault is None


@pytest.mark.slow
def test_leaving_the_workers_in_mid_match_ends_them_and_their_agents(submit: Submit, out: Path) -> None:
    sleeper = submit("sleeper", SLEEPER)
    only = job(sleeper, 0, out)
    log = out / only.log(0)

    with Workers(2) as workers:
        results = workers.run([only, job(submit("walker", WALKER), 0, out)])
        assert next(results).job.submission.name == "walker"
        while not log.exists() or not log.read_text().strip():
            time.sleep(0.05)
        agent = Path("/proc") / log.read_text().strip()
        assert agent.exists()

    assert not agent.exists()


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not tell of a parent's end")
def test_a_worker_whose_parent_is_gone_before_it_began_ends_at_once() -> None:
    code = "import os; from wildscav_evaluator.matches.workers import end_with_parent; end_with_parent({})"

    with_parent = [sys.executable, "-c", code.format("os.getppid()")]
    without = [sys.executable, "-c", code.format("os.getppid() + 1")]

    assert subprocess.run(with_parent).returncode == 0
    assert subprocess.run(without).returncode == 128 + signal.SIGTERM
