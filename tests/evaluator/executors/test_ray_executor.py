"""A Ray cluster plays matches and carries out calls as this machine does, and is left clean.

What happens to its nodes is the subject of ``test_ray_nodes.py``.
"""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.evaluator.executors.ray_clusters import RayCluster, ray_cluster
from tests.evaluator.executors.ray_evaluations import PATIENCE, check_equal, options
from tests.evaluator.interrupted_runs import Sitting, contents, entered, files
from tests.evaluator.sample_agents import KILLS_ITS_FIRST_WORKER, TALKER, Command, Submit
from tests.evaluator.sandbox.sandbox_runs import processes_with, wait_until
from tests.evaluator.small_matches import job_of, need

from wildscav_engine.maps import cache
from wildscav_evaluator.executors import ExecutorError
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.executors.ray_executor import RayExecutor
from wildscav_evaluator.map_making import choices_of_pool, make_maps, missing_maps
from wildscav_evaluator.matches.jobs import AttemptFailed, Job, JobEvent
from wildscav_evaluator.matches.workers import Workers
from wildscav_evaluator.sandbox.process import WARNING

pytestmark = [pytest.mark.slow, pytest.mark.long]
# Kills the parent of its parent, once.
KILLS_RAYS_PROCESS = KILLS_ITS_FIRST_WORKER.replace(
    "os.getppid()", 'int(open(f"/proc/{os.getppid()}/stat").read().rpartition(")")[2].split()[1])'
)


@pytest.fixture(scope="module")
def two_nodes() -> Iterator[RayCluster]:
    """A cluster of two nodes with two cores each, which this process may use, and which no test changes."""
    with ray_cluster("east", "west", cores=2) as cluster, pytest.MonkeyPatch.context() as environment:
        cluster.use(environment)
        yield cluster


@pytest.fixture(scope="module")
def executor(two_nodes: RayCluster) -> Iterator[RayExecutor]:
    """A connection to the cluster, whose token is known."""
    with pytest.MonkeyPatch.context() as environment:
        environment.delenv("RAY_AUTH_MODE")  # without being told to send it
        with RayExecutor(2, two_nodes.address) as connected:
            yield connected


def test_values_of_calls_come_in_the_order_of_the_items(executor: RayExecutor) -> None:
    assert list(executor.map(json.loads, map(str, range(10)))) == list(range(10))


def test_a_call_that_fails_is_told_in_one_line_with_its_node(executor: RayExecutor) -> None:
    with pytest.raises(ExecutorError, match=r"^a call failed on (east|west): .*Expecting value: line 1"):
        list(executor.map(json.loads, ["9", "ten"]))


def test_maps_that_nodes_make_are_those_of_this_machine(
    executor: RayExecutor, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cache, "folder", lambda: tmp_path / "maps")
    choices = choices_of_pool("easy", "test", 3, 3)
    made = list(make_maps(choices, executor))

    assert made == list(make_maps(choices, LocalExecutor(1)))
    assert missing_maps(choices) == []


def test_another_token_is_refused_in_one_line(
    two_nodes: RayCluster, wildscav: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RAY_AUTH_TOKEN", "0" * 64)
    done = wildscav("doctor", "--executor=ray", f"--address={two_nodes.address}")
    assert done.returncode == 1
    assert "asks for another authentication token" in " ".join(done.stderr.split())


def test_matches_are_those_of_this_machine_and_a_process_that_is_killed_costs_an_attempt(
    executor: RayExecutor, submit: Submit, tmp_path: Path
) -> None:
    """One process of ours and one of Ray's are killed once, one match kills each, and one is not begun."""
    # Outside of its folder, because a node does not use a submission again that was changed there.
    worker = KILLS_ITS_FIRST_WORKER.replace('"was_here"', repr(str(tmp_path / "worker was here")))
    host = KILLS_RAYS_PROCESS.replace('"was_here"', repr(str(tmp_path / "host was here")))
    killer = KILLS_RAYS_PROCESS.replace(' and not os.path.exists("was_here")', "")
    bodies = {"talker": TALKER, "worker": worker, "host": host, "killer": killer, "withheld": TALKER}
    submissions = [submit(name, body) for name, body in bodies.items()]
    out = tmp_path / "out"
    jobs = [job_of(one, out) for one in submissions]
    lost: dict[str, list[str]] = {}

    def note(job: Job, event: JobEvent) -> None:
        if isinstance(event, AttemptFailed):
            lost.setdefault(job.evaluated, []).append(event.reason)

    def is_begun(job: Job) -> bool:
        return job.evaluated != "withheld"

    choice, _ = executor.choose_sandbox("process", submissions)
    with executor.players(jobs) as players:
        results = {result.job.evaluated: result for result in players.run(jobs, is_begun, note)}

    there = contents(out)
    assert choice.warnings == (WARNING,)
    assert {name: len(reasons) for name, reasons in lost.items()} == {"worker": 1, "host": 1, "killer": 2}, (
        lost
    )
    assert "SIGKILL" in lost["worker"][0]
    assert all(
        reason.startswith(("a process on east was lost", "a process on west was lost"))
        for reason in lost["host"] + lost["killer"]
    )
    given_up = results.pop("killer").row
    assert (given_up.status, given_up.fault) == ("failed", "platform")
    assert "was lost" in given_up.detail
    assert {result.row.status for result in results.values()} == {"finished"}
    assert {node.name: node.running for node in executor.nodes} == {"east": 0, "west": 0}
    assert sum(node.done for node in executor.nodes) == 3
    for path in out.rglob("*.*"):
        path.unlink()
    with Workers(1) as workers:
        here = {result.job.evaluated: result for result in workers.run(jobs[:3])}
    assert contents(out) == there
    assert {name: one.row for name, one in results.items()} == {name: one.row for name, one in here.items()}


def test_a_command_that_is_interrupted_leaves_nothing_running_and_goes_on_where_it_was(
    plodder: Path, plodder_here: Path, suite: Path, two_nodes: RayCluster, tmp_path: Path
) -> None:
    """In a sandbox, in which the logs are those of this machine, too."""
    need("bubblewrap")
    there = tmp_path / "there"
    arguments = (plodder, *options(two_nodes, suite, "bubblewrap"), "--workers=2")
    interrupted = Sitting(there, *arguments)
    interrupted.await_matches(1)
    wait_until(lambda: bool(agents_of(two_nodes)), PATIENCE)
    agents = agents_of(two_nodes)
    interrupted.interrupt()
    assert interrupted.process.wait(60) == 130
    assert "interrupted" in interrupted.errors
    wait_until(lambda: not any(Path(f"/proc/{one}").exists() for one in agents))
    kept = entered(there)

    last = Sitting(there, *arguments)
    assert last.process.wait(PATIENCE) == 0, last.errors

    assert last.errors == ""
    check_equal(there, plodder_here)
    assert files(there, "logs") == files(plodder_here, "logs")
    assert kept
    assert {stem: entered(there)[stem] for stem in kept} == kept


def agents_of(cluster: RayCluster) -> list[int]:
    """Return the agents that run on a cluster, as their parents tell: they have no environment of ours."""
    owners = set(cluster.processes())
    return [one for one in processes_with("agent:Player") if parent_of(one) in owners]


def parent_of(process: int) -> int:
    """Return the parent of a process; 0 if it has ended."""
    try:
        return int(Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[1])
    except OSError:
        return 0
