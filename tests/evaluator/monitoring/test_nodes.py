"""The machines of a cluster are in the dashboard, the metrics and the log."""

import io
import json

import pytest
from rich.console import Console
from tests.evaluator.monitoring.jobs_by_hand import jobs

from wildscav_evaluator.executors import Node
from wildscav_evaluator.matches.jobs import Heartbeat
from wildscav_evaluator.monitoring.dashboard import dashboard
from wildscav_evaluator.monitoring.monitor import EvaluationMetrics, Monitor, MonitorOptions
from wildscav_evaluator.monitoring.tally import Tally

NODES = (
    Node("east", cores=64, running=12, done=1500),
    Node("west", cores=8, problem="it was lost"),
)


@pytest.mark.parametrize("width", [60, 100])
def test_the_dashboard_shows_each_node(width: int) -> None:
    console = Console(file=io.StringIO(), width=width, record=True)
    console.print(dashboard(Tally(jobs(navigation=2), nodes=lambda: NODES), "title", width))

    lines = [" ".join(line.split()) for line in console.export_text().splitlines()]
    assert lines[lines.index("nodes 1 with 64 cores") :][1:3] == [
        "east 64 cores 1,500 done 12 running",
        "west 8 cores 0 done not used",
    ]


def test_an_evaluation_on_this_machine_shows_no_nodes() -> None:
    console = Console(file=io.StringIO(), width=100, record=True)
    console.print(dashboard(Tally(jobs(navigation=2)), "title", 100))
    shown = console.export_text()
    assert "title" in shown
    assert "nodes" not in shown
    assert not [family for family in EvaluationMetrics(Tally([])).collect() if "node" in family.name]


def test_the_metrics_have_each_node() -> None:
    families = EvaluationMetrics(Tally([], nodes=lambda: NODES)).collect()
    values = {
        (one.name, one.labels["node"]): one.value
        for family in families
        for one in family.samples
        if "node" in one.labels
    }

    assert values["wildscav_node_used", "east"] == 1
    assert values["wildscav_node_used", "west"] == 0
    assert values["wildscav_node_cores", "east"] == 64
    assert values["wildscav_node_matches_running", "east"] == 12
    assert values["wildscav_node_matches_total", "east"] == 1500


def test_a_node_that_is_lost_is_told_once(capsys: pytest.CaptureFixture[str]) -> None:
    now = [Node("east", cores=64), NODES[1]]  # one had its problem from the beginning
    played = jobs(navigation=1)
    monitor = Monitor(played, 1, "suite", MonitorOptions("json", None), lambda: tuple(now))
    monitor.start(played[0])
    now[0] = Node("east", cores=64, problem="it was lost")
    for steps in (1, 2):
        monitor.handle(played[0], Heartbeat(5 * steps, steps))

    events = [json.loads(line) for line in capsys.readouterr().err.splitlines()]
    (lost,) = (event for event in events if event["event"] == "node_not_used")
    assert (lost["node"], lost["detail"]) == ("east", "it was lost")
