"""Evaluations on a Ray cluster give what they give on this machine, whatever happens to its nodes."""

import json
import shutil
import sys
from pathlib import Path

import pytest
from tests.evaluator.executors.ray_clusters import ray_cluster
from tests.evaluator.executors.ray_evaluations import PATIENCE, check_equal, faults, options
from tests.evaluator.interrupted_runs import Sitting, entered, files
from tests.evaluator.sample_agents import Command
from tests.evaluator.sandbox.available import missing
from tests.evaluator.small_matches import need

import wildscav_engine

pytestmark = [pytest.mark.slow, pytest.mark.long]


def test_nodes_that_are_killed_cost_their_matches_an_attempt_and_nobody_a_result(
    plodder: Path, plodder_here: Path, suite: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with ray_cluster("east", "west") as cluster:
        cluster.use(monkeypatch)
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
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The one that can plays in a container what is played here without a sandbox."""
    need("oci")
    other = tmp_path / "other version"
    shutil.copytree(Path(wildscav_engine.__file__).parent, other / "wildscav_engine")
    version = other / "wildscav_engine" / "version.py"
    version.write_text(version.read_text().replace("SIMULATION_VERSION = ", "SIMULATION_VERSION = 9"))
    (tmp_path / "without" / "wildscav_evaluator").mkdir(parents=True)
    (tmp_path / "without" / "wildscav_evaluator" / "__init__.py").touch()
    there = tmp_path / "there"
    with ray_cluster("good") as cluster:
        cluster.use(monkeypatch)
        cluster.add("old", PYTHONPATH=str(other))
        cluster.add("empty", PYTHONPATH=str(tmp_path / "without"))
        cluster.add("bare", PATH=str(Path(sys.executable).parent))
        only = ("--track=battle", f"--out={there}")
        done = wildscav("evaluate", plodder, *options(cluster, suite, "oci"), *only)
        doctor = wildscav("doctor", "--executor=ray", "--json", f"--address={cluster.address}")

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
