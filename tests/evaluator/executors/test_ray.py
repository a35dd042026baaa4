"""A Ray cluster plays matches as this machine does, whatever happens to its nodes, and is left clean."""

import json
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.commands import run_command
from tests.evaluator.conftest import submission_in
from tests.evaluator.executors.match_files import contents
from tests.evaluator.executors.ray_clusters import RayCluster, ray_cluster
from tests.evaluator.interrupted_runs import Sitting, check_whole, entered, files, without_timings
from tests.evaluator.sample_agents import TALKER, Command, Submit
from tests.evaluator.sandbox.available import missing
from tests.evaluator.sandbox.sandbox_runs import processes_with, wait_until

import wildscav_engine
from wildscav_engine.maps import cache
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.cli.sessions.rescore import run_rescore
from wildscav_evaluator.executors import ExecutorError
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.executors.ray_executor import RayExecutor
from wildscav_evaluator.ledger.ledger import read_ledger
from wildscav_evaluator.map_making import choices_of_pool, make_maps, missing_maps
from wildscav_evaluator.matches.jobs import AttemptFailed, Job, JobEvent
from wildscav_evaluator.matches.workers import Workers
from wildscav_evaluator.output.layout import LOGS, RECORDS, REPLAYS, RESULTS_FILE
from wildscav_evaluator.sandbox.process import WARNING

SUITE = """
name = "short"

[map]
size = 40
houses = 0

[tracks.navigation]
maps = 2
episodes = 2
match = { time_limit = 4 }

[tracks.battle]
maps = 1
episodes = 1
match = { time_limit = 4, seats = ["submission", "fighter", "submission"] }
"""
MATCHES = 5
PATIENCE = 900.0  # s, of a busy machine: nodes that were lost take their time to be replaced
# Slow enough to be killed in the middle of a match.
PLODDER = """
    def act(self, observation):
        print("step", observation.step)
        time.sleep(0.05)
        return Action(walk_direction=observation.step * 10.0, walk_speed=6.0)
"""


def options(cluster: RayCluster, suite: Path, sandbox: str = "process") -> list[str]:
    """Return the options of an evaluation on a cluster."""
    on_cluster = ["--executor=ray", f"--address={cluster.address}"]
    return [*on_cluster, f"--suite={suite}", f"--sandbox={sandbox}", "--replays=none"]


def played_here(folder: Path, suite: Path, out: Path) -> Path:
    """Play the same matches on this machine."""
    done = run_command(
        *("evaluate", folder, f"--suite={suite}", "--sandbox=process", "--replays=none"),
        *("--workers=1", f"--out={out}"),
    )
    assert done.returncode == 0, done.stderr
    return out


def check_equal(out: Path, expected: Path) -> None:
    """Everything but the timings is the same, byte for byte, and every match has exactly one result."""
    check_whole(out)
    assert files(out, "records") == files(expected, "records")
    there, here = without_timings(out), without_timings(expected)
    for name in ("sandbox", "limits"):  # of which nothing else depends
        del there[name], here[name]
    assert there == here
    ledger = read_ledger(out)
    assert ledger is not None
    assert Counter(len([end for end in ends if end.record]) for ends in ledger.ended.values()) == {1: MATCHES}


def faults(out: Path) -> list[str]:
    """What the platform broke, by the results."""
    matches = json.loads((out / RESULTS_FILE).read_text())["timings"]["matches"]
    return [fault for match in matches for fault in match["platform_faults"]]


@pytest.fixture(scope="session")
def suite(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A suite of a few short matches."""
    path = tmp_path_factory.mktemp("suite") / "short.toml"
    path.write_text(SUITE)
    return path


@pytest.fixture(scope="session")
def plodder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a submission that takes its time."""
    place = tmp_path_factory.mktemp("submissions")
    return submission_in(place, "plodder", PLODDER, tracks='["navigation", "battle"]').folder


@pytest.fixture(scope="session")
def plodder_here(plodder: Path, suite: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The plodder's evaluation on this machine."""
    return played_here(plodder, suite, tmp_path_factory.mktemp("here") / "out")


KILLS_ITS_FIRST_WORKER = """
    def act(self, observation):
        if observation.step == 7 and not os.path.exists("was_here"):
            open("was_here", "w").close()
            os.kill(os.getppid(), signal.SIGKILL)
            time.sleep(600)
        return Action(walk_speed=5.0)
"""
KILLS_RAYS_PROCESS = KILLS_ITS_FIRST_WORKER.replace(
    "os.getppid()", 'int(open(f"/proc/{os.getppid()}/stat").read().rpartition(")")[2].split()[1])'
)
pytestmark = pytest.mark.slow
SPEC = MatchSpec(track="navigation", map=MapSpec(config=MapConfig(size=40, houses=0)), time_limit=2.0)


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


@pytest.fixture
def out(tmp_path: Path) -> Path:
    for name in (RECORDS, REPLAYS, LOGS):
        (tmp_path / "out" / name).mkdir(parents=True)
    return tmp_path / "out"


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
    executor: RayExecutor, submit: Submit, tmp_path: Path, out: Path
) -> None:
    """One of ours and one of Ray's is killed once; of four matches, the last kills each that plays it."""
    # Outside of its folder, because a node does not use a submission again that was changed there.
    worker = KILLS_ITS_FIRST_WORKER.replace('"was_here"', repr(str(tmp_path / "worker was here")))
    host = KILLS_RAYS_PROCESS.replace('"was_here"', repr(str(tmp_path / "host was here")))
    killer = KILLS_RAYS_PROCESS.replace(' and not os.path.exists("was_here")', "")
    bodies = {"talker": TALKER, "worker": worker, "host": host, "killer": killer}
    submissions = [submit(name, body) for name, body in bodies.items()]
    jobs = [Job.of_one(one, "navigation", 0, SPEC, out, replay=False) for one in submissions]
    lost: dict[str, list[str]] = {}

    def note(job: Job, event: JobEvent) -> None:
        if isinstance(event, AttemptFailed):
            lost.setdefault(job.evaluated, []).append(event.reason)

    choice, _ = executor.choose_sandbox("process", submissions)
    with executor.players(jobs) as players:
        results = {result.job.evaluated: result for result in players.run(jobs, on_event=note)}

    there = contents(out)
    assert choice.warnings == (WARNING,)
    assert {name: len(reasons) for name, reasons in lost.items()} == {"worker": 1, "host": 1, "killer": 2}
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


def test_a_command_that_is_killed_or_interrupted_leaves_nothing_running_and_goes_on_where_it_was(
    plodder: Path, plodder_here: Path, suite: Path, two_nodes: RayCluster, tmp_path: Path
) -> None:
    """In a sandbox, in which the logs are those of this machine, too."""
    if why := missing("bubblewrap"):
        pytest.skip(f"bubblewrap does not work here: {why}")
    there = tmp_path / "there"
    arguments = (plodder, *options(two_nodes, suite, "bubblewrap"), "--workers=2")
    Sitting(there, *arguments).kill_at(1)
    kept = entered(there)
    interrupted = Sitting(there, *arguments)
    interrupted.await_begin()
    wait_until(lambda: bool(agents_of(two_nodes)), PATIENCE)
    agents = agents_of(two_nodes)
    interrupted.interrupt()
    assert interrupted.process.wait(60) == 130
    assert "interrupted" in interrupted.errors
    wait_until(lambda: not any(Path(f"/proc/{one}").exists() for one in agents))

    last = Sitting(there, *arguments)
    assert last.process.wait(PATIENCE) == 0, last.errors

    assert last.errors == ""
    check_equal(there, plodder_here)
    assert files(there, "logs") == files(plodder_here, "logs")
    assert {stem: entered(there)[stem] for stem in kept} == kept
    with RayExecutor(1, two_nodes.address) as executor:
        run_rescore(there, executor)


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


@pytest.fixture
def environment() -> Iterator[pytest.MonkeyPatch]:
    """The environment of this process, which is as before after the test."""
    with pytest.MonkeyPatch.context() as environment:
        yield environment


def test_nodes_that_are_killed_cost_their_matches_an_attempt_and_nobody_a_result(
    plodder: Path, plodder_here: Path, suite: Path, tmp_path: Path, environment: pytest.MonkeyPatch
) -> None:
    with ray_cluster("east", "west") as cluster:
        cluster.use(environment)
        sitting = Sitting(tmp_path / "there", plodder, *options(cluster, suite))
        sitting.await_matches(2)
        cluster.kill("east")
        cluster.add("north")  # joins while the command runs, and plays what is left
        cluster.kill("west")
        assert sitting.process.wait(PATIENCE) == 0

        lost = Sitting(tmp_path / "lost", plodder, *options(cluster, suite))
        lost.await_matches(1)
        cluster.kill("head")
        assert lost.process.wait(PATIENCE) == 1

    check_equal(sitting.out, plodder_here)
    assert all("east" in fault or "west" in fault for fault in faults(sitting.out))
    printed = sitting.printed.read_text()
    assert "node east is not used: it was lost" in printed
    assert "node north" not in printed

    (line,) = lost.errors.splitlines()  # of a cluster that is lost as a whole
    assert "the Ray cluster" in line
    assert "matches are saved in" in line
    assert "run the same command again to play the rest" in line
    assert entered(lost.out)


def test_nodes_that_cannot_play_are_named_and_get_no_work(
    *,
    plodder: Path,
    plodder_here: Path,
    suite: Path,
    wildscav: Command,
    tmp_path: Path,
    environment: pytest.MonkeyPatch,
) -> None:
    """The one that can plays in a container what is played here without a sandbox."""
    if why := missing("oci"):
        pytest.skip(f"oci does not work here: {why}")
    other = tmp_path / "other version"
    shutil.copytree(Path(wildscav_engine.__file__).parent, other / "wildscav_engine")
    version = other / "wildscav_engine" / "version.py"
    version.write_text(version.read_text().replace("SIMULATION_VERSION = ", "SIMULATION_VERSION = 9"))
    (tmp_path / "without" / "wildscav_evaluator").mkdir(parents=True)
    (tmp_path / "without" / "wildscav_evaluator" / "__init__.py").touch()
    there = tmp_path / "there"
    with ray_cluster("good") as cluster:
        cluster.use(environment)
        cluster.add("old", PYTHONPATH=str(other))
        cluster.add("empty", PYTHONPATH=str(tmp_path / "without"))
        cluster.add("bare", PATH=str(Path(sys.executable).parent))
        only = ("--track=battle", f"--out={there}")
        done = wildscav("evaluate", plodder, *options(cluster, suite, "oci"), *only)
        doctor = doctor_of(cluster, wildscav)

    assert done.returncode == 0, done.stderr
    printed = " ".join(done.stdout.split())
    assert "node old is not used: it has another version of Wildscav: simulation 9" in printed
    assert "node empty is not used: Wildscav does not run there" in printed
    assert "node bare is not used: oci does not work there" in printed
    assert "node good" not in printed
    assert files(there, "records").items() <= files(plodder_here, "records").items()
    by_name = {node["name"]: node for node in json.loads(doctor.stdout)["nodes"]}
    for sandbox in ("bubblewrap", "oci"):
        assert by_name["good"]["sandboxes"][sandbox] == missing(sandbox)
        assert by_name["bare"]["sandboxes"][sandbox] != ""
    assert "simulation 9" in by_name["old"]["problem"]


def test_a_cluster_of_another_release_of_ray_is_refused_in_one_line(
    wildscav: Command, environment: pytest.MonkeyPatch
) -> None:
    with ray_cluster(ray_version="2.55.0") as cluster:
        cluster.use(environment)
        refused = doctor_of(cluster, wildscav)

    assert refused.returncode == 1
    assert refused.stderr.startswith(f"wildscav: the Ray cluster at {cluster.address} runs Ray 2.55.0")
    assert len(refused.stderr.splitlines()) == 1


def doctor_of(cluster: RayCluster, wildscav: Command) -> "subprocess.CompletedProcess[str]":
    return wildscav("doctor", "--executor=ray", "--json", f"--address={cluster.address}")
