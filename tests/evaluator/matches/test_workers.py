"""Workers: the match of one that dies is played again, and costs nobody anything."""

import itertools
import json
import multiprocessing
import tempfile
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import KILLS_ITS_FIRST_WORKER, SLEEPER, WALKER, Submit
from tests.evaluator.small_matches import SMALL, job_of

from wildscav_engine.record import read_record, verify_record
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.jobs import Job, JobEvent, JobResult, RenderingReplay
from wildscav_evaluator.matches.play import MatchAssignment
from wildscav_evaluator.matches.snapshots import HEARTBEAT_INTERVAL
from wildscav_evaluator.matches.watchdog import ProgressTimeouts
from wildscav_evaluator.matches.workers import Workers
from wildscav_evaluator.monitoring.dashboard import match_counts
from wildscav_evaluator.monitoring.monitor import EvaluationMetrics, Monitor, MonitorOptions
from wildscav_evaluator.sandbox import Limits
from wildscav_evaluator.submissions.submission import Submission

KILLS_EVERY_WORKER = """
    def act(self, observation):
        os.kill(os.getppid(), signal.SIGKILL)
        time.sleep(600)
"""
# Stops the worker, as if the worker hung.
STOPS_EVERY_WORKER = """
    def act(self, observation):
        if observation.step == 7:
            open("was_here", "w").close()
            time.sleep(1.0)  # in which the worker says how far it is
            os.kill(os.getppid(), signal.SIGSTOP)
        return Action(walk_speed=5.0)
"""
# Says at every step that it plays, and plays for so long that its worker tells of it.
SLOW_TALKER = """
    def act(self, observation):
        print("step", observation.step, flush=True)
        time.sleep(0.2)
        return Action(walk_speed=5.0)
"""
STEPS = 20


@pytest.fixture
def out(tmp_path: Path) -> Path:
    return tmp_path / "out"


@pytest.fixture
def sockets(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Where workers have their sockets: a path that is short enough for them."""
    with tempfile.TemporaryDirectory() as folder:
        monkeypatch.setenv("TMPDIR", folder)
        monkeypatch.setattr(tempfile, "tempdir", None)
        yield Path(folder)
        monkeypatch.undo()


def job(submission: Submission, index: int, out: Path) -> Job:
    spec = MatchSpec(track="navigation", map=SMALL, seed=index, time_limit=STEPS / 10)
    return job_of(submission, out, index, spec)


def run(
    jobs: list[Job],
    count: int,
    watch: Monitor | None = None,
    timeouts: ProgressTimeouts | None = None,
    refused: Job | None = None,  # when its turn comes
) -> dict[tuple[str, int], JobResult]:
    watch = watch or Monitor(jobs, count, "suite", MonitorOptions("json", None))
    with Workers(count, timeouts=timeouts) as workers:
        workers.precompile()
        given = jobs if refused is None else [refused, *jobs]
        for result in workers.run(given, lambda one: one != refused and watch.start(one), watch.handle):
            watch.add(result)
    return {(result.job.evaluated, result.job.index): result for result in watch.tally.done.values()}


@pytest.mark.slow
def test_a_match_whose_worker_is_killed_is_played_again_in_another(
    submit: Submit, out: Path, sockets: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    walker, unlucky = submit("walker", WALKER), submit("unlucky", KILLS_ITS_FIRST_WORKER)
    jobs = [job(walker, 0, out), job(unlucky, 0, out), job(walker, 1, out), job(walker, 2, out)]
    watch = Monitor(jobs, 1, "suite", MonitorOptions("json", None))

    results = run(jobs, 1, watch, refused=job(walker, 3, out))

    assert len(results) == len(jobs)
    assert all(result.row.fault is None for result in results.values())
    again = results["unlucky", 0]
    assert again.timing is not None
    assert again.timing.platform_faults == ("the worker process died (SIGKILL)",)
    assert (again.row.status, again.row.seats[0].actions, again.timing.steps) == ("finished", STEPS, STEPS)
    assert (out / again.job.log(0)).read_text().splitlines() == [f"step {step}" for step in range(STEPS)]
    assert verify_record(read_record(out / again.job.record)).holds
    check_told(watch, capsys.readouterr().err)
    assert list(sockets.iterdir()) == []


def check_told(watch: Monitor, log: str) -> None:
    """One match was played again: so say the log, the metrics and the dashboard."""
    events = [json.loads(line) for line in log.splitlines()]
    (broken,) = (event for event in events if event["event"] == "match_broken")
    assert (broken["match"], broken["fault"]) == ("navigation-000-unlucky", "platform")
    assert broken["detail"] == "the worker process died (SIGKILL)"
    samples = {
        one.name: one.value for family in EvaluationMetrics(watch.tally).collect() for one in family.samples
    }
    assert samples["wildscav_platform_retries_total"] == 1
    assert "4 of 4 matches done, 0 failed, 1 played again" in str(match_counts(watch.tally))


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


@pytest.mark.slow
def test_a_match_that_was_played_is_kept_even_if_its_replay_kills_every_worker(
    submit: Submit, out: Path
) -> None:
    written = []

    def kill(playing: Job, event: JobEvent) -> None:
        if isinstance(event, RenderingReplay):
            written.append((out / playing.record).stat().st_mtime_ns)
            for worker in multiprocessing.active_children():
                worker.kill()

    with Workers(1) as workers:
        (kept,) = workers.run([replace(job(submit("walker", WALKER), 0, out), replay=True)], on_event=kill)

    assert (len(written), len({*written})) == (3, 1), "it was not played once, and rendered three times"
    assert (kept.row.status, kept.row.replay) == ("finished", None)
    why = "the platform failed 3 times: the worker process died (SIGKILL)"
    assert kept.replay_error == f"no replay {out / kept.job.replay_path}: {why}"


@pytest.mark.slow
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
def test_leaving_the_workers_in_mid_match_ends_them_and_their_agents(
    submit: Submit, out: Path, sockets: Path
) -> None:
    sleeper = submit("sleeper", SLEEPER)
    only = job(sleeper, 0, out)
    log = out / only.log(0)

    with Workers(2) as workers:
        results = workers.run([only, job(submit("walker", WALKER), 0, out)])
        assert next(results).job.evaluated == "walker"
        while not log.exists() or not log.read_text().strip():
            time.sleep(0.05)
        agent = Path("/proc") / log.read_text().strip()
        assert agent.exists()

    assert not agent.exists()
    assert list(sockets.iterdir()) == []


class Spins(Job):
    """A job that gets lost, holding Python's lock, in a step of its first attempt."""

    @property
    def seating(self) -> MatchAssignment:
        if not self.faults:
            threading.Thread(target=self._spin, daemon=True).start()
        return super().seating

    def _spin(self) -> None:
        """Spin once the agent has said that it plays, and the worker how far it is."""
        log = self.out / self.log(0)
        while not (log.exists() and log.read_text()):
            time.sleep(0.05)
        time.sleep(2.0 * HEARTBEAT_INTERVAL)
        sum(itertools.repeat(0))


@pytest.mark.slow
def test_a_worker_that_spins_in_compiled_code_is_killed_and_its_match_played_again(
    submit: Submit, out: Path, sockets: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    limits = Limits(wall_clock=STEPS / 10 + 7.0)  # which leaves 7 s to the bank
    spins = Spins(**vars(replace(job(submit("slow", SLOW_TALKER), 0, out), limits=limits)))

    results = run([spins], 1, timeouts=ProgressTimeouts(step=7.8))

    (result,) = results.values()
    assert result.row.status == "finished"
    assert result.timing is not None
    (fault,) = result.timing.platform_faults
    assert fault.startswith("the worker process hung: no progress in 15 s after step ")
    assert fault in capsys.readouterr().err
    assert list(sockets.iterdir()) == []


@pytest.mark.slow
def test_a_worker_that_hangs_when_all_is_interrupted_is_killed(
    submit: Submit, out: Path, sockets: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wildscav_evaluator.matches.workers.STOP_TIME", 1.0)
    stopper, walker = submit("stopper", STOPS_EVERY_WORKER), submit("walker", WALKER)

    with Workers(2) as workers:
        next(workers.run([job(stopper, 0, out), job(walker, 0, out)]))
        processes = [worker.process for worker in workers._workers]
        while not (stopper.folder / "was_here").exists():
            time.sleep(0.05)

    assert [process.is_alive() for process in processes] == [False, False]
    assert list(sockets.iterdir()) == []


STOPS_ITS_FIRST_WORKER_AND_FAILS = """
    def act(self, observation):
        if not os.path.exists("was_here"):
            open("was_here", "w").close()
            worker = os.getppid()
            subprocess.Popen(["sh", "-c", f"sleep 12; kill -CONT {worker}"], start_new_session=True)
            os.kill(worker, signal.SIGSTOP)
            os._exit(1)
        return Action(walk_speed=5.0)
"""


@pytest.mark.slow
def test_no_agent_is_blamed_for_what_happens_while_its_worker_is_stopped(submit: Submit, out: Path) -> None:
    unlucky = submit("unlucky", STOPS_ITS_FIRST_WORKER_AND_FAILS)

    (result,) = run([job(unlucky, 0, out)], 1).values()

    assert result.row.status == "finished"
    assert result.timing is not None
    (fault,) = result.timing.platform_faults
    assert fault.startswith("the evaluator stood still for 1")
