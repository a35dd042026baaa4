"""Workers: the match of one that dies is played again, and costs nobody anything."""

import json
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import pytest
from tests.evaluator.players import SLEEPER, WALKER, Submit

from wildscav_engine.record import read_record, verify_record
from wildscav_engine.spec import MapConfig, MapSpec, MatchSpec
from wildscav_evaluator.matches.jobs import LOGS, RECORDS, REPLAYS, Job, JobResult, after_death
from wildscav_evaluator.matches.workers import Workers
from wildscav_evaluator.output.journal import MATCHES
from wildscav_evaluator.submissions.submission import Submission
from wildscav_evaluator.watch.dashboard import standing
from wildscav_evaluator.watch.metrics import EvaluationMetrics
from wildscav_evaluator.watch.watch import Watch, Watching

KILLS_EVERY_WORKER = """
    def act(self, observation):
        os.kill(os.getppid(), signal.SIGKILL)
        time.sleep(600)
"""
KILLS_ITS_FIRST_WORKER = """
    def act(self, observation):
        print("step", observation.step)
        if observation.step == 7 and not os.path.exists("was_here"):
            open("was_here", "w").close()
            os.kill(os.getppid(), signal.SIGKILL)
            time.sleep(600)
        return Action(walk_speed=5.0)
"""
STEPS = 20


@pytest.fixture
def out(tmp_path: Path) -> Path:
    for name in (RECORDS, REPLAYS, LOGS, MATCHES):
        (tmp_path / "out" / name).mkdir(parents=True)
    return tmp_path / "out"


def job(submission: Submission, index: int, out: Path) -> Job:
    small = MapSpec(config=MapConfig(size=40, houses=0))
    spec = MatchSpec(track="navigation", map=small, seed=index, time_limit=STEPS / 10)
    return Job(submission, "navigation", index, spec, out, replay=False)


def run(jobs: list[Job], count: int, watch: Watch | None = None) -> dict[tuple[str, int], JobResult]:
    watch = watch or Watch(jobs, count, "suite", Watching("json", None))
    with Workers(count) as workers:
        workers.warm()
        for result in workers.run(jobs, watch.start, watch.tell):
            watch.add(result)
    return {(result.job.submission.name, result.job.index): result for result in watch.tally.done.values()}


@pytest.mark.parametrize("count", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_a_match_whose_worker_is_killed_is_played_again_in_another(
    submit: Submit, out: Path, capsys: pytest.CaptureFixture[str], count: int
) -> None:
    walker, unlucky = submit("walker", WALKER), submit("unlucky", KILLS_ITS_FIRST_WORKER)
    jobs = [job(walker, 0, out), job(unlucky, 0, out), job(walker, 1, out), job(walker, 2, out)]
    watch = Watch(jobs, count, "suite", Watching("json", None))
    before = set(Path(tempfile.gettempdir()).glob("wildscav-*"))

    results = run(jobs, count, watch)

    assert len(results) == len(jobs)
    assert all(result.row.fault is None for result in results.values())
    again = results["unlucky", 0]
    assert again.timing is not None
    assert again.timing.platform_faults == ("the worker process died (SIGKILL)",)
    assert (again.row.status, again.row.seats[0].actions, again.timing.steps) == ("finished", STEPS, STEPS)
    assert (out / again.job.log(0)).read_text().splitlines() == [f"step {step}" for step in range(STEPS)]
    assert verify_record(read_record(out / again.job.record)).holds
    check_told(watch, capsys.readouterr().err)
    assert set(Path(tempfile.gettempdir()).glob("wildscav-*")) <= before, "sockets were left behind"


def check_told(watch: Watch, log: str) -> None:
    """One match was played again: so say the log, the metrics and the dashboard."""
    events = [json.loads(line) for line in log.splitlines()]
    (broken,) = (event for event in events if event["event"] == "match_broken")
    assert (broken["match"], broken["fault"]) == ("navigation-000-unlucky", "platform")
    assert broken["detail"] == "the worker process died (SIGKILL)"
    samples = {
        one.name: one.value for family in EvaluationMetrics(watch.tally).collect() for one in family.samples
    }
    assert samples["wildscav_platform_retries_total"] == 1
    assert "4 of 4 matches done, 0 failed, 1 played again" in str(standing(watch.tally))


@pytest.mark.slow
def test_a_match_that_kills_every_worker_is_given_up_as_the_platforms_fault(
    submit: Submit, out: Path
) -> None:
    walker, killer = submit("walker", WALKER), submit("killer", KILLS_EVERY_WORKER)

    results = run([job(killer, 0, out), job(walker, 0, out)], 1)

    dead = results["killer", 0].row
    assert (dead.status, dead.fault, dead.metrics, dead.seats) == ("failed", "platform", None, ())
    assert dead.detail == "the platform failed 3 times: the worker process died (SIGKILL)"
    assert results["walker", 0].row.fault is None
    assert not (out / results["killer", 0].job.record).exists()


def test_a_match_that_was_played_is_kept_even_if_its_replay_kills_every_worker(
    submit: Submit, out: Path
) -> None:
    only = job(submit("walker", WALKER), 0, out)
    (played,) = run([only], 1).values()

    again = after_death(replace(only, replay=True), "killed")
    assert isinstance(again, Job)
    again = after_death(again, "killed")
    assert isinstance(again, Job)
    kept = after_death(again, "killed once more")

    assert isinstance(kept, JobResult)
    assert kept.row == played.row
    assert kept.complaint.endswith(".rrd: the platform failed 3 times: killed; killed once more")


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
    before = set(Path(tempfile.gettempdir()).glob("wildscav-*"))

    with Workers(2) as workers:
        results = workers.run([only, job(submit("walker", WALKER), 0, out)])
        assert next(results).job.submission.name == "walker"
        while not log.exists() or not log.read_text().strip():
            time.sleep(0.05)
        agent = Path("/proc") / log.read_text().strip()
        assert agent.exists()

    assert not agent.exists()
    assert set(Path(tempfile.gettempdir()).glob("wildscav-*")) <= before, "sockets were left behind"
