"""What a Ray cluster costs for each match beside local processes, and how it scales from 1 to 2 cores.

It plays a sample of the official suite, and starts a cluster of one node on this machine for it.
"""

import contextlib
import os
import secrets
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from multiprocessing import active_children
from pathlib import Path
from typing import NamedTuple

import typer
from benchmarks.report import Figure, JsonFile, processor_time, publish

from wildscav_engine.maps.cache import map_of
from wildscav_evaluator.executors import Executor
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.executors.ray_executor import RayExecutor
from wildscav_evaluator.ledger.writer import LedgerWriter
from wildscav_evaluator.matches.jobs import Job, JobResult
from wildscav_evaluator.output.layout import LOGS, RECORDS, REPLAYS
from wildscav_evaluator.plans.evaluation import EvaluationPlan
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_evaluator.suites.seeds import SuiteSeed
from wildscav_evaluator.suites.suite import SUITES

HOMING = Path(__file__).parents[2] / "submissions" / "homing"
SAMPLE = {"navigation": 4, "gathering": 3, "battle": 1}  # the first matches of the official suite
NODE = "127.0.0.2"  # a loopback address that Ray does not replace by another of this machine's
START_TIME = 60.0  # s


class Run(NamedTuple):
    """What it took to play the sample."""

    wall: float  # s, from the first match to the last result
    in_matches: float  # s, the sum over all matches
    processor: float  # s of processor time of this process and of the one that talks to the cluster
    results: tuple[JobResult, ...]

    @property
    def between(self) -> float:
        """Time for each match in which no match was played, s; only of one match at a time."""
        return (self.wall - self.in_matches) / len(self.results)

    def latency(self, name: str) -> float:
        """Return the mean over all matches of a statistic of the agents' answers, ms."""
        timings = [result.timing for result in self.results if result.timing is not None]
        return 1000 * statistics.mean(getattr(seat, name) for one in timings for seat in one.seats)


@contextlib.contextmanager
def one_node(cores: int) -> Iterator[str]:
    """Run a cluster of one node on this machine; yield its address."""
    os.environ |= {"RAY_AUTH_MODE": "token", "RAY_AUTH_TOKEN": secrets.token_hex(32)}
    with socket.create_server((NODE, 0)) as free:
        port = free.getsockname()[1]
    command = (
        *(str(Path(sys.executable).with_name("ray")), "start", "--head", "--block"),
        *("--disable-usage-stats", "--include-dashboard=false"),
        *(f"--node-ip-address={NODE}", f"--port={port}", f"--num-cpus={cores}"),
    )
    quiet = subprocess.DEVNULL
    with subprocess.Popen(command, stdout=quiet, stderr=quiet) as process:
        try:
            _await_cluster(port)
            yield f"{NODE}:{port}"
        finally:
            process.terminate()


def _await_cluster(port: int) -> None:
    deadline = time.monotonic() + START_TIME
    while time.monotonic() < deadline:
        with contextlib.suppress(OSError):
            socket.create_connection((NODE, port), 1.0).close()
            time.sleep(5.0)  # the node joins a little after its head listens
            return
        time.sleep(0.1)
    raise RuntimeError(f"no cluster started within {START_TIME:.0f} s")


def plan_in(out: Path) -> EvaluationPlan:
    """Return an official evaluation that writes to a folder."""
    for name in (RECORDS, REPLAYS, LOGS):
        (out / name).mkdir(parents=True, exist_ok=True)
    return EvaluationPlan(
        submissions=(load_submission(HOMING),),
        tracks=tuple(SAMPLE),
        suite=SUITES["official"],
        seed=SuiteSeed(0),
        replays="none",
        jobs=1,
        out=out,
    )


def sample(plan: EvaluationPlan) -> list[Job]:
    """Return the jobs of the sample."""
    return [job for job in plan.make_jobs() if job.index < SAMPLE[job.track]]


def play(executor: Executor, out: Path) -> Run:
    """Play the sample."""
    jobs = sample(plan_in(out))
    with executor, executor.players(jobs) as players:
        processor, began = processor_time_here(), time.perf_counter()
        results = tuple(players.run(jobs))
        wall = time.perf_counter() - began
        processor = processor_time_here() - processor
    in_matches = sum(result.timing.wall for result in results if result.timing is not None)
    return Run(wall, in_matches, processor, results)


def processor_time_here() -> float:
    """Return the processor time of this process, and of the one that talks to the cluster, s."""
    return time.process_time() + sum(processor_time(child.pid or 0) for child in active_children())


def ledger_time(out: Path, results: tuple[JobResult, ...]) -> float:
    """Return the time to enter a match in the ledger, at its begin and at its end, s."""
    plan = plan_in(out)
    ledger = LedgerWriter(out, plan.identity(), None)
    began = time.perf_counter()
    for result in results:
        ledger.begin(result.job.stem)
        ledger.end(result)
    return (time.perf_counter() - began) / len(results)


def figures(folder: Path) -> list[Figure]:
    """Measure."""
    local = play(LocalExecutor(1), folder / "local")
    with one_node(2) as address:
        one = play(RayExecutor(1, address), folder / "one")
        two = play(RayExecutor(2, address), folder / "two")
    mean = statistics.mean(result.timing.wall for result in local.results if result.timing)
    extra = one.between - local.between
    count = len(local.results)
    return [
        Figure("a match", mean, "s", f"mean of {count} of the official suite, played by homing"),
        Figure("between two matches, local", 1000 * local.between, "ms", "one at a time"),
        Figure("between two matches, Ray", 1000 * one.between, "ms", "one at a time"),
        Figure("overhead of Ray", 100 * extra / mean, "%", "of a match"),
        Figure("matches a second, Ray, 1 core", count / one.wall, "/s"),
        Figure("matches a second, Ray, 2 cores", count / two.wall, "/s", f"{one.wall / two.wall:.2f} times"),
        Figure("median answer, 1 match", one.latency("latency_p50"), "ms", "on 2 cores"),
        Figure("median answer, 2 matches", two.latency("latency_p50"), "ms", "on 2 cores"),
        Figure("99 of 100 answers, 1 match", one.latency("latency_p99"), "ms", "on 2 cores"),
        Figure("99 of 100 answers, 2 matches", two.latency("latency_p99"), "ms", "on 2 cores"),
        Figure("processor time here, Ray", 1000 * two.processor / count, "ms", "for each match"),
        Figure("the ledger", 1000 * ledger_time(folder / "one", one.results), "ms", "for each match"),
    ]


def main(json_file: JsonFile = None) -> None:
    """Measure and print."""
    for job in sample(plan_in(Path(tempfile.mkdtemp()))):
        map_of(job.spec.map)  # none is generated while the others are timed
    with tempfile.TemporaryDirectory() as folder:
        publish(
            "Executors: a Ray cluster of one node beside local processes", figures(Path(folder)), json_file
        )


if __name__ == "__main__":
    typer.run(main)
