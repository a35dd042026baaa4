"""What an evaluation shows while it runs."""

import io
import re
from collections.abc import Callable
from pathlib import Path

from rich.console import Console

from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.jobs import Job, JobResult
from wildscav_evaluator.monitoring.monitor import EvaluationProgress
from wildscav_evaluator.monitoring.tally import Tally
from wildscav_evaluator.output.results import MatchRow
from wildscav_evaluator.submissions.submission import Submission

Submit = Callable[..., Submission]
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


def test_the_table_is_there_before_the_first_match_ends(submit: Submit, tmp_path: Path) -> None:
    job = Job.of_one(submit("walker"), "navigation", 0, MatchSpec(track="navigation"), tmp_path, replay=False)
    console = Console(file=io.StringIO(), force_terminal=True, width=80)

    with EvaluationProgress(console, Tally([job])).shown():
        assert isinstance(console.file, io.StringIO)
        assert "walker" in console.file.getvalue()


def test_where_nobody_watches_each_finished_line_has_its_count_and_unit(
    submit: Submit, tmp_path: Path
) -> None:
    printed = shown(submit, tmp_path, terminal=False)

    assert "walker on navigation: 1 match, 7.0 s used + punish time" in printed
