"""Text of strangers in every field that holds text: everybody's results are shown and kept all the same."""

import io
import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from rich.console import RenderableType
from tests.evaluator.monitoring.jobs_by_hand import jobs
from tests.evaluator.results_by_hand import evaluation_of, results_of
from tests.platform.helpers.plain_text import is_plain

from wildscav.terminal.console import PlainConsole
from wildscav_evaluator.check.findings import Finding, Verdict
from wildscav_evaluator.cli.result_tables import sandbox_and_limits, timing_table, track_table
from wildscav_evaluator.cli.sessions import check as checking
from wildscav_evaluator.cli.sessions import compare as compare_session
from wildscav_evaluator.cli.sessions import evaluate as session
from wildscav_evaluator.cli.sessions import leaderboard as leaderboard_session
from wildscav_evaluator.cli.sessions import playing as playing_session
from wildscav_evaluator.cli.sessions import rescore as rescore_session
from wildscav_evaluator.cli.sessions import verify_records as verify
from wildscav_evaluator.cli.sessions.playing import raise_errors
from wildscav_evaluator.matches.jobs import JobResult
from wildscav_evaluator.monitoring.dashboard import dashboard
from wildscav_evaluator.monitoring.monitor import EvaluationProgress
from wildscav_evaluator.monitoring.tally import Tally
from wildscav_evaluator.output.results import KeptLimits, read_results, write_results
from wildscav_evaluator.scores.compare import compare
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_server.hosting.manifest import SubmissionError

# JSON, protobuf and SQLite hold no halves of characters, so none comes out of them.
TEXT = st.text(st.characters(exclude_categories=("Cs",)), min_size=1, max_size=20)
HOSTILE = "[/]\x1b]0;mine\x07\x9b2J\u202e[red]"


@pytest.fixture
def screen(monkeypatch: pytest.MonkeyPatch) -> PlainConsole:
    """A terminal of 60 columns in place of every console."""
    console = PlainConsole(file=io.StringIO(), width=60, color_system=None)
    for module in (session, checking, compare_session, rescore_session, leaderboard_session, playing_session):
        monkeypatch.setattr(module, "console", console)
    monkeypatch.setattr("wildscav_evaluator.cli.sessions.playing.error_console", console)
    return console


def written_on(console: PlainConsole) -> str:
    assert isinstance(console.file, io.StringIO)
    text = console.file.getvalue()
    console.file.seek(0)
    console.file.truncate()
    return text


ways = settings(suppress_health_check=[HealthCheck.function_scoped_fixture])


@ways
@given(text=TEXT)
@example(text=HOSTILE)
def test_tables_of_results_show_everybody(text: str, screen: PlainConsole) -> None:
    results = results_of(text, "honest")

    session._show(results)
    assert list(rescore_session._show(results)) == []
    plan = SimpleNamespace(out=Path("out"), public_key=None)
    playing_session.say_files(plan, None, results)  # type: ignore[arg-type]

    shown = written_on(screen)
    assert is_plain(shown)
    assert shown.count("honest honest") == 2, "the honest submission stands in the table of each command"


@ways
@given(text=TEXT.filter(lambda text: text != "honest"))
@example(text=HOSTILE)
def test_a_comparison_and_complaints_are_plain(text: str, screen: PlainConsole) -> None:
    results = results_of(text, "honest")
    for one in compare(results, text, "honest").comparisons:
        screen.print(compare_session.comparison_table(one))
        screen.print(compare_session.verdict_line(one))
    with pytest.raises(Exception, match="honest"):
        raise_errors([session.all_failed(one, Path(text)) for one in results.evaluations])
    checking._explain(Finding(text, Verdict.BROKEN, text, text, (text,)))
    screen.print(verify._table([verify.Finding(Path("a/b"), False, text)]))
    assert is_plain(written_on(screen))


@ways
@given(text=TEXT)
@example(text=HOSTILE)
def test_the_progress_of_an_evaluation_is_plain(text: str) -> None:
    (job,) = jobs(navigation=1)
    console = PlainConsole(file=io.StringIO(), width=60, color_system=None)
    tally = Tally([job])
    progress = EvaluationProgress(console, tally)
    tally.start(job)
    console.print(dashboard(tally, text, 60))
    progress.note_broken(job, text)
    (row,) = evaluation_of(text).matches
    result = JobResult(job, row, replay_error=text)
    progress.add(result, tally.add(result))
    assert is_plain(written_on(console))


@ways
@given(text=TEXT)
@example(text=HOSTILE)
def test_what_is_kept_says_the_same_and_its_files_are_plain(
    text: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("out")
    results = results_of(text, "honest")
    path = write_results(results, folder)
    assert read_results(path) == results
    assert is_plain(path.read_text("utf-8"))
    json.loads(path.read_text("ascii"))


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=15)
@given(text=TEXT.filter(lambda text: text != "honest"))
@example(text=HOSTILE)
def test_the_leaderboard_takes_and_shows_everybody(
    text: str, tmp_path_factory: pytest.TempPathFactory, screen: PlainConsole
) -> None:
    path = write_results(results_of(text, "honest"), tmp_path_factory.mktemp("out"))

    leaderboard_session.show_standings([path])

    shown = written_on(screen)
    assert is_plain(shown)
    assert "honest honest" in shown


FIELDS: dict[str, Callable[[str], str]] = {
    "name": json.dumps,
    "version": json.dumps,
    "entry_point": json.dumps,
    "tracks": lambda text: json.dumps([text]),
    "sensors": lambda text: f"{{ {json.dumps(text)} = {{}} }}",
    "sensors.depth": lambda text: f"{{ {json.dumps(text)} = {json.dumps(text)} }}",
}
GOOD = {"name": '"mine"', "version": '"1"', "entry_point": '"agent:Agent"', "tracks": '["navigation"]'}


@pytest.mark.parametrize("field", FIELDS)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=30)
@given(text=TEXT)
@example(text=HOSTILE)
@example(text="[/]")
def test_a_manifest_is_read_or_refused_in_a_plain_line(
    field: str, text: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("submission")
    (folder / "agent.py").write_text("class Agent: ...")
    content = GOOD | {field: FIELDS[field](text)}
    (folder / "submission.toml").write_text(
        "".join(f"{name} = {value}\n" for name, value in content.items()), "utf-8"
    )
    console = PlainConsole(file=io.StringIO(), width=60, color_system=None)
    said: RenderableType
    try:
        said = track_table(results_of(load_submission(folder).manifest.version), "navigation")
    except SubmissionError as error:
        said = str(error)
    console.print(said, soft_wrap=True)
    shown = written_on(console)
    assert is_plain(shown)
    assert shown.strip()


def test_the_conditions_and_times_of_any_sandbox_are_plain() -> None:
    console = PlainConsole(file=io.StringIO(), width=60, color_system=None)
    for line in sandbox_and_limits(HOSTILE, {HOSTILE: KeptLimits(memory=1)}):
        console.print(line)
    console.print(timing_table(results_of(HOSTILE)))
    assert is_plain(written_on(console))
