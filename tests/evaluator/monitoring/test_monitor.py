"""What an evaluation tells machines and people while it runs: metrics, log lines, nodes and failures."""

import io
import json
import re
import urllib.request
from pathlib import Path

import pytest
from prometheus_client.parser import text_string_to_metric_families
from rich.console import Console
from tests.evaluator.monitoring.jobs_by_hand import jobs, played
from tests.evaluator.results_by_hand import plan_of
from tests.evaluator.sample_agents import WALKER, Submit
from tests.evaluator.small_matches import tiny_suite

from wildscav.errors import UserError
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.cli.sessions.evaluate import run_session
from wildscav_evaluator.executors import Node
from wildscav_evaluator.matches.jobs import Heartbeat, Job, JobResult
from wildscav_evaluator.monitoring.dashboard import dashboard
from wildscav_evaluator.monitoring.monitor import (
    EvaluationMetrics,
    EvaluationProgress,
    Monitor,
    MonitorOptions,
)
from wildscav_evaluator.monitoring.tally import Tally
from wildscav_evaluator.output.results import MatchRow
from wildscav_evaluator.suites.suite_file import read_suite
from wildscav_server.monitoring.logs import open_log
from wildscav_server.monitoring.metrics import serving_metrics


def scraped(address: str | None) -> dict[tuple[str, ...], float]:
    """Every sample by its name and the values of its labels, in the order of their names."""
    assert address is not None
    with urllib.request.urlopen(address) as answer:  # noqa: S310
        text = answer.read().decode()
    return {
        (sample.name, *(sample.labels[name] for name in sorted(sample.labels))): sample.value
        for family in text_string_to_metric_families(text)
        for sample in family.samples
    }


def test_metrics_tell_matches_queue_steps_latency_and_faults() -> None:
    every = jobs(navigation=6)
    tally = Tally(every, at_once=2)
    with serving_metrics(EvaluationMetrics(tally), 0) as address:
        assert scraped(address)["wildscav_matches_waiting",] == 6

        tally.add(played(every[0], 5.0))
        tally.add(played(every[1], 5.0))
        tally.add(played(every[2], 5.0, fault=True))
        tally.start(every[3])
        tally.beat(every[3], Heartbeat(10, 2))
        samples = scraped(address)

    assert samples["wildscav_matches_total", "finished", "walker", "navigation"] == 2
    assert samples["wildscav_matches_total", "crashed", "walker", "navigation"] == 1
    assert samples["wildscav_faults_total", "agent"] == 1
    assert samples["wildscav_faults_total", "platform"] == 0
    assert samples["wildscav_matches_running",] == 1
    assert samples["wildscav_matches_waiting",] == 2
    assert samples["wildscav_steps_total", "navigation"] == 300
    assert samples["wildscav_step_latency_seconds_count", "walker", "navigation"] == 300
    assert samples["wildscav_step_latency_seconds_sum", "walker", "navigation"] == 3.0
    assert samples["wildscav_steps_per_second",] == 0


def test_a_port_that_is_taken_is_one_clear_line() -> None:
    tally = Tally(jobs(navigation=1))
    with serving_metrics(EvaluationMetrics(tally), 0) as address:
        assert address is not None
        port = int(address.split(":")[2].split("/")[0])
        with pytest.raises(UserError, match=f"--metrics-port {port} cannot be used: Address already in use"):
            serving_metrics(EvaluationMetrics(tally), port).__enter__()
    with serving_metrics(EvaluationMetrics(tally), None) as none:
        assert none is None


def test_log_lines_say_what_happened_with_which_values(capsys: pytest.CaptureFixture[str]) -> None:
    every = jobs(navigation=2)
    watch = Monitor(every, 1, "suite quick · seed 0", MonitorOptions("json", None))

    with watch.shown():
        watch.start(every[0])
        watch.add(played(every[0], 5.0, fault=True))
    lines = [json.loads(line) for line in capsys.readouterr().err.splitlines()]

    assert [line["event"] for line in lines] == [
        "evaluation_begins",
        "match_begins",
        "match_ends",
        "evaluation_ends",
    ]
    ended = lines[2]
    assert (ended["level"], ended["match"], ended["fault"]) == ("warning", "navigation-000-walker", "agent")
    assert (ended["steps"], ended["seats"][0]["latency_p99"]) == (100, 0.01)
    assert all(line["timestamp"].endswith("Z") for line in lines)


def test_text_is_for_people_and_without_a_form_nothing_is_written(capsys: pytest.CaptureFixture[str]) -> None:
    open_log(None).warning("unheard", match=1)
    assert capsys.readouterr().err == ""

    open_log("text").info("match_ends", match="navigation-000-walker")
    said = capsys.readouterr().err
    assert "match_ends" in said
    assert "match=navigation-000-walker" in said


@pytest.mark.slow
def test_an_evaluation_is_watched_while_it_runs(
    submit: Submit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    suite = read_suite(tiny_suite(tmp_path, maps=2, seconds=1))
    run_session(
        plan_of(submit("walker", WALKER), out=tmp_path / "out", suite=suite), MonitorOptions("json", 0)
    )

    said = capsys.readouterr()
    assert "metrics   http://127.0.0.1:" in said.out
    events = [json.loads(line) for line in io.StringIO(said.err) if line.startswith("{")]
    assert [one["event"] for one in events].count("match_ends") == 2
    assert (events[-1]["event"], events[-1]["failed"]) == ("evaluation_ends", 0)


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


DETAIL = "the agent's process ended (exit code 3): RuntimeError: [red]lost[/red] the thread, and much more"


def shown(submit: Submit, tmp_path: Path, *, terminal: bool) -> str:
    """What is printed when one of two matches fails and the other does not."""
    jobs = [
        Job.of_one(submit(name), "navigation", 0, MatchSpec(track="navigation"), tmp_path, replay=False)
        for name in ("crasher", "walker")
    ]
    console = Console(file=io.StringIO(), force_terminal=terminal, width=80, color_system=None)
    tally = Tally(jobs)
    progress = EvaluationProgress(console, tally)
    with progress.shown():
        failed = MatchRow(index=0, status="crashed", fault="agent", detail=DETAIL)
        result = JobResult(jobs[0], failed)
        progress.add(result, tally.add(result))
        metrics = {"time": 7.0, "used_time": 7.0, "punish_time": 0.0, "success": 1.0}
        result = JobResult(jobs[1], MatchRow(index=0, status="finished", metrics=metrics))
        progress.add(result, tally.add(result))
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


def test_a_failure_is_said_whole_above_the_live_table(submit: Submit, tmp_path: Path) -> None:
    lines = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", shown(submit, tmp_path, terminal=True)).splitlines()

    start = next(at for at, line in enumerate(lines) if "navigation-000-crasher: crashed" in line)
    assert " ".join(line.strip() for line in lines[start : start + 3]).startswith(
        f"navigation-000-crasher: crashed, agent's fault: {DETAIL}"
    )
    assert all(len(line) <= 80 for line in lines)


def test_the_table_is_there_before_the_first_match_ends() -> None:
    console = Console(file=io.StringIO(), force_terminal=True, width=80)

    with EvaluationProgress(console, Tally(jobs(navigation=1))).shown():
        assert isinstance(console.file, io.StringIO)
        assert "walker" in console.file.getvalue()


def test_where_nobody_watches_each_finished_line_has_its_count_and_unit(
    submit: Submit, tmp_path: Path
) -> None:
    printed = shown(submit, tmp_path, terminal=False)

    assert "walker on navigation: 1 match, 7.0 s used + punish time" in printed
