"""What an evaluation tells machines: metrics and log lines."""

import io
import json
import urllib.request
from pathlib import Path

import pytest
from prometheus_client.parser import text_string_to_metric_families
from tests.evaluator.monitoring.jobs_by_hand import jobs, played
from tests.evaluator.results_by_hand import plan_of

from wildscav.errors import UserError
from wildscav_evaluator.cli.sessions.evaluate import run_session
from wildscav_evaluator.matches.jobs import Heartbeat
from wildscav_evaluator.monitoring.monitor import EvaluationMetrics, Monitor, MonitorOptions
from wildscav_evaluator.monitoring.tally import Tally
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_evaluator.suites.suite_file import read_suite
from wildscav_server.monitoring.logs import open_log
from wildscav_server.monitoring.metrics import serving_metrics

HOMING = Path(__file__).parents[3] / "submissions" / "homing"
SUITE = 'name = "short"\nmap = { size = 40, houses = 0 }\n[tracks.navigation]\nmaps = 2\n'


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
def test_an_evaluation_is_watched_while_it_runs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "short.toml").write_text(SUITE)
    plan = plan_of(load_submission(HOMING), out=tmp_path / "out", suite=read_suite(tmp_path / "short.toml"))

    run_session(plan, MonitorOptions("json", 0))

    said = capsys.readouterr()
    assert "metrics   http://127.0.0.1:" in said.out
    events = [json.loads(line) for line in io.StringIO(said.err) if line.startswith("{")]
    assert [one["event"] for one in events].count("match_ends") == 2
    assert events[-1]["event"] == "evaluation_ends"
    assert events[-1]["failed"] == 0
