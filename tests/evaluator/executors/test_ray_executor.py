"""Evaluations on a Ray cluster give what they give on this machine, whatever happens to its nodes."""

import json
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
from tests.commands import run_command
from tests.evaluator.conftest import submission_in
from tests.evaluator.executors.ray_clusters import RayCluster, ray_cluster
from tests.evaluator.executors.unlucky_agents import KILLS_RAYS_PROCESS
from tests.evaluator.interrupted_runs import Sitting, check_whole, entered, files, without_timings
from tests.evaluator.sample_agents import TALKER, Command, Submit
from tests.evaluator.sandbox.available import missing
from tests.evaluator.sandbox.sandbox_runs import processes_with, wait_until

import wildscav_engine
from wildscav_engine.maps import cache
from wildscav_evaluator.cli.sessions.rescore import run_rescore
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.executors.ray_executor import RayExecutor
from wildscav_evaluator.ledger.ledger import read_ledger
from wildscav_evaluator.map_making import choices_of_pool, make_maps, missing_maps
from wildscav_evaluator.output.layout import RESULTS_FILE

pytestmark = pytest.mark.slow
SUITE = """
name = "short"

[map]
size = 40
houses = 0

[tracks.navigation]
maps = 3
episodes = 2
match = { time_limit = 4 }

[tracks.battle]
maps = 1
episodes = 1
match = { time_limit = 4, seats = ["submission", "fighter", "submission"] }
"""
MATCHES = 7
PATIENCE = 900.0  # s, of a busy machine: nodes that were lost take their time to be replaced
# Slow enough to be killed in the middle of a match.
PLODDER = """
    def act(self, observation):
        time.sleep(0.05)
        return Action(walk_direction=observation.step * 10.0, walk_speed=6.0)
"""
BOTH = '["navigation", "battle"]'


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("ray")


@pytest.fixture(scope="module")
def suite(place: Path) -> Path:
    path = place / "short.toml"
    path.write_text(SUITE)
    return path


@pytest.fixture(scope="module")
def plodder(place: Path) -> Path:
    return submission_in(place, "plodder", PLODDER, tracks=BOTH).folder


@pytest.fixture(scope="module")
def plodder_here(place: Path, plodder: Path, suite: Path) -> Path:
    """The plodder's evaluation on this machine."""
    return played_here(plodder, suite, place / "plodder here")


@pytest.fixture(scope="module")
def talker_here(place: Path, suite: Path) -> Path:
    """The evaluation on this machine of a submission that prints."""
    return played_here(
        submission_in(place, "talker", TALKER, tracks=BOTH).folder, suite, place / "talker here"
    )


def options(cluster: RayCluster, suite: Path, sandbox: str = "process") -> list[str]:
    on_cluster = ["--executor=ray", f"--address={cluster.address}"]
    return [*on_cluster, f"--suite={suite}", f"--sandbox={sandbox}", "--replays=none"]


def played_here(folder: Path, suite: Path, out: Path) -> Path:
    """Play the same matches on this machine."""
    done = run_command(
        *("evaluate", folder, f"--suite={suite}", "--sandbox=process", "--replays=none"),
        f"--out={out}",
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


@pytest.mark.parametrize("sandbox", ["bubblewrap", "oci"])
def test_a_cluster_gives_the_records_and_scores_of_this_machine(
    *,
    place: Path,
    suite: Path,
    talker_here: Path,
    in_cluster: RayCluster,
    wildscav: Command,
    tmp_path: Path,
    sandbox: str,
) -> None:
    if why := missing(sandbox):
        pytest.skip(f"{sandbox} does not work here: {why}")
    there = tmp_path / "there"

    done = wildscav(
        *("evaluate", place / "talker", *options(in_cluster, suite, sandbox)),
        f"--out={there}",
    )

    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    check_equal(there, talker_here)
    assert files(there, "logs") == files(talker_here, "logs")
    with RayExecutor(2, in_cluster.address) as executor:
        run_rescore(there, executor)


def test_a_cluster_that_asks_for_a_token_gets_the_one_that_is_known(
    in_cluster: RayCluster, wildscav: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    doctor = ("doctor", "--executor=ray", f"--address={in_cluster.address}")
    monkeypatch.delenv("RAY_AUTH_MODE")
    done = wildscav(*doctor)
    assert done.returncode == 0, done.stderr

    monkeypatch.setenv("RAY_AUTH_TOKEN", "0" * 64)
    done = wildscav(*doctor)
    assert done.returncode == 1
    assert "asks for another authentication token" in " ".join(done.stderr.split())


def test_nodes_that_are_killed_cost_their_matches_an_attempt_and_nobody_a_result(
    plodder: Path, plodder_here: Path, suite: Path, tmp_path: Path
) -> None:
    with ray_cluster("east", "west") as cluster, pytest.MonkeyPatch.context() as environment:
        use(cluster, environment)
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


def test_maps_that_nodes_make_are_those_of_this_machine(
    in_cluster: RayCluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cache, "folder", lambda: tmp_path / "maps")
    choices = choices_of_pool("easy", "test", 3, 5)
    with RayExecutor(None, in_cluster.address) as executor:
        made = list(make_maps(choices, executor))

    assert made == list(make_maps(choices, LocalExecutor(1)))
    assert missing_maps(choices) == []


def test_a_match_whose_process_is_killed_is_played_again_unless_it_kills_every_one(
    submit: Submit, suite: Path, tmp_path: Path
) -> None:
    killer = submit("killer", KILLS_RAYS_PROCESS.replace(' and not os.path.exists("was_here")', ""))
    # Outside of its folder, because a node does not use a submission again that was changed there.
    once = KILLS_RAYS_PROCESS.replace('"was_here"', repr(str(tmp_path / "was_here")))
    unlucky, walker = submit("unlucky", once), submit("walker", PLODDER)
    only = tmp_path / "one.toml"
    only.write_text(SUITE.replace("maps = 3", "maps = 1").replace("episodes = 2", "episodes = 1"))
    with ray_cluster("east") as cluster, pytest.MonkeyPatch.context() as environment:
        use(cluster, environment)
        folders = (one.folder for one in (killer, unlucky, walker))
        sitting = Sitting(tmp_path / "there", *folders, *options(cluster, only), "--track=navigation")
        assert sitting.process.wait(PATIENCE) == 1  # the killer failed in every match

    check_whole(sitting.out)
    assert faults(sitting.out)
    evaluations = without_timings(sitting.out)["evaluations"]
    rows = {one["submission"]: one["matches"][0] for one in evaluations}  # type: ignore[attr-defined]
    assert (rows["killer"]["status"], rows["killer"]["fault"]) == ("failed", "platform")
    assert "a process on east was lost" in rows["killer"]["detail"]
    assert rows["unlucky"]["status"] == rows["walker"]["status"] == "finished"


def test_a_command_that_is_killed_or_interrupted_leaves_nothing_running_and_goes_on_where_it_was(
    plodder: Path, plodder_here: Path, suite: Path, in_cluster: RayCluster, tmp_path: Path
) -> None:
    there = tmp_path / "there"
    arguments = (plodder, *options(in_cluster, suite))
    Sitting(there, *arguments).kill_at(1)
    kept = entered(there)
    interrupted = Sitting(there, *arguments)
    interrupted.await_begin()
    wait_until(lambda: bool(agents_of(in_cluster)), PATIENCE)
    agents = agents_of(in_cluster)
    interrupted.interrupt()
    assert interrupted.process.wait(60) == 130
    assert "interrupted" in interrupted.errors
    wait_until(lambda: not any(Path(f"/proc/{one}").exists() for one in agents))

    assert Sitting(there, *arguments).process.wait(PATIENCE) == 0

    check_equal(there, plodder_here)
    assert {stem: entered(there)[stem] for stem in kept} == kept


def test_nodes_that_cannot_play_are_named_and_get_no_work(
    submit: Submit, suite: Path, tmp_path: Path
) -> None:
    walker = submit("walker", PLODDER)
    other = tmp_path / "other version"
    shutil.copytree(Path(wildscav_engine.__file__).parent, other / "wildscav_engine")
    version = other / "wildscav_engine" / "version.py"
    version.write_text(version.read_text().replace("SIMULATION_VERSION = ", "SIMULATION_VERSION = 9"))
    (tmp_path / "without" / "wildscav_evaluator").mkdir(parents=True)
    (tmp_path / "without" / "wildscav_evaluator" / "__init__.py").touch()
    with ray_cluster("good") as cluster, pytest.MonkeyPatch.context() as environment:
        use(cluster, environment)
        cluster.add("old", PYTHONPATH=str(other))
        cluster.add("empty", PYTHONPATH=str(tmp_path / "without"))
        cluster.add("bare", PATH=str(Path(sys.executable).parent))
        arguments = options(cluster, suite, "bubblewrap")
        if why := missing("bubblewrap"):
            pytest.skip(f"bubblewrap does not work here: {why}")
        sitting = Sitting(tmp_path / "there", walker.folder, *arguments)
        assert sitting.process.wait(PATIENCE) == 0
        doctor = doctor_of(cluster)

    printed = " ".join(sitting.printed.read_text().split())
    assert "node old is not used: it has another version of Wildscav: simulation 9" in printed
    assert "node empty is not used: Wildscav does not run there" in printed
    assert "node bare is not used: bubblewrap does not work there" in printed
    assert "node good" not in printed
    by_name = {node["name"]: node for node in json.loads(doctor.stdout)["nodes"]}
    assert by_name["good"]["sandboxes"]["bubblewrap"] == ""
    assert by_name["bare"]["sandboxes"]["bubblewrap"] != ""
    assert "simulation 9" in by_name["old"]["problem"]


def test_a_cluster_of_another_release_of_ray_is_refused_in_one_line(wildscav: Command) -> None:
    with ray_cluster(ray_version="2.55.0") as cluster, pytest.MonkeyPatch.context() as environment:
        use(cluster, environment)
        refused = doctor_of(cluster)

    assert refused.returncode == 1
    assert refused.stderr.startswith(f"wildscav: the Ray cluster at {cluster.address} runs Ray 2.55.0")
    assert len(refused.stderr.splitlines()) == 1


def use(cluster: RayCluster, environment: pytest.MonkeyPatch) -> None:
    """Let this process and its children use a cluster."""
    for name, value in cluster.environment.items():
        if name.startswith("RAY_"):
            environment.setenv(name, value)


def doctor_of(cluster: RayCluster) -> "subprocess.CompletedProcess[str]":
    command = [str(Path(sys.executable).with_name("wildscav")), "doctor", "--executor=ray", "--json"]
    return subprocess.run(
        [*command, f"--address={cluster.address}"],
        check=False,
        capture_output=True,
        text=True,
        env=cluster.environment,
        timeout=300,
    )


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
