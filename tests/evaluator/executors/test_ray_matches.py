"""Matches and calls on a small Ray cluster: the parts of ``test_ray_executor.py`` that are quick."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.evaluator.executors.match_files import contents
from tests.evaluator.executors.ray_clusters import RayCluster
from tests.evaluator.executors.unlucky_agents import KILLS_ITS_FIRST_WORKER
from tests.evaluator.sample_agents import TALKER, Submit

from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.executors import ExecutorError
from wildscav_evaluator.executors.base import Examined
from wildscav_evaluator.executors.ray_executor import RayExecutor, _no_sandbox
from wildscav_evaluator.matches.jobs import AttemptFailed, Job, JobEvent
from wildscav_evaluator.matches.workers import Workers
from wildscav_evaluator.output.layout import LOGS, RECORDS, REPLAYS
from wildscav_evaluator.sandbox.process import WARNING

SPEC = MatchSpec(track="navigation", map=MapSpec(config=MapConfig(size=40, houses=0)), time_limit=2.0)


@pytest.fixture(scope="module")
def executor(two_nodes: RayCluster) -> Iterator[RayExecutor]:
    """A connection to the shared cluster."""
    with pytest.MonkeyPatch.context() as environment:
        for name, value in two_nodes.environment.items():
            if name.startswith("RAY_"):
                environment.setenv(name, value)
        with RayExecutor(None, two_nodes.address) as connected:
            yield connected


@pytest.fixture
def out(tmp_path: Path) -> Path:
    for name in (RECORDS, REPLAYS, LOGS):
        (tmp_path / "out" / name).mkdir(parents=True)
    return tmp_path / "out"


@pytest.mark.slow
def test_values_of_calls_come_in_the_order_of_the_items(executor: RayExecutor) -> None:
    assert list(executor.map(json.loads, map(str, range(10)))) == list(range(10))


@pytest.mark.slow
def test_a_call_that_fails_is_told_in_one_line_with_its_node(executor: RayExecutor) -> None:
    with pytest.raises(ExecutorError, match=r"^a call failed on (east|west): .*Expecting value: line 1"):
        list(executor.map(json.loads, ["9", "ten"]))


@pytest.mark.slow
def test_matches_are_those_of_this_machine_although_a_worker_is_killed(
    executor: RayExecutor, submit: Submit, tmp_path: Path, out: Path
) -> None:
    unlucky = KILLS_ITS_FIRST_WORKER.replace('"was_here"', repr(str(tmp_path / "was_here")))
    submissions = (submit("talker", TALKER), submit("unlucky", unlucky))
    jobs = [Job.of_one(one, "navigation", 0, SPEC, out, replay=False) for one in submissions]
    happened: list[tuple[str, JobEvent]] = []

    choice, _ = executor.choose_sandbox("process", submissions)
    with executor.players(jobs) as players:
        results = list(players.run(jobs, on_event=lambda job, event: happened.append((job.stem, event))))

    there = contents(out)
    assert choice.warnings == (WARNING,)
    (failed,) = [(stem, event) for stem, event in happened if isinstance(event, AttemptFailed)]
    assert failed[0] == jobs[1].stem
    assert "SIGKILL" in failed[1].reason
    assert {result.row.status for result in results} == {"finished"}
    assert {node.name: node.running for node in executor.nodes} == {"east": 0, "west": 0}
    assert sum(node.done for node in executor.nodes) == 2
    for path in out.rglob("*.*"):
        path.unlink()
    with Workers(1) as workers:
        here = {result.job.stem: result for result in workers.run(jobs)}
    assert contents(out) == there
    assert {result.job.stem: result.row for result in results} == {
        stem: one.row for stem, one in here.items()
    }


@pytest.mark.parametrize(
    ("found", "reason"),
    [
        ([], "the Ray cluster has no node with cores"),
        (
            [Examined("east", 2, "it has other code"), Examined("west", 2, "it is old")],
            "no node of the Ray cluster can be used (east: it has other code; west: it is old)",
        ),
        (
            [Examined("east", 2, "", {"oci": "there is no Docker"}), Examined("west", 2, "it is old")],
            (
                "no node of the Ray cluster can run agents in oci (east: oci: there is no Docker; west: it "
                "is old); to run agents that you trust as plain processes, name --sandbox process"
            ),
        ),
    ],
)
def test_why_no_node_can_play(found: list[Examined], reason: str) -> None:
    assert _no_sandbox(found, ["oci"]) == reason


def test_an_executor_that_was_not_entered_does_nothing(submit: Submit) -> None:
    with pytest.raises(RuntimeError, match="not entered"):
        RayExecutor().choose_sandbox("process", [submit("talker", TALKER)])
