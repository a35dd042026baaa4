"""What ``wildscav check`` shows: a table of the findings, and how to fix failures."""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path

from rich.table import Table
from rich.text import Text

from wildscav.errors import UserError
from wildscav.terminal.console import console, counted, print_json, telling
from wildscav_engine.compilation.engine_progress import preparing
from wildscav_evaluator.check.findings import Finding, Verdict
from wildscav_evaluator.check.trials import Trial, run_checks
from wildscav_evaluator.cli.result_tables import plain_table
from wildscav_evaluator.sandbox import Sandbox
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server.hosting.precompile import precompile_for

STYLES = {Verdict.KEPT: "green", Verdict.DOUBTFUL: "yellow", Verdict.BROKEN: "red"}
SHOWN_LINES = 8  # of what a failing agent printed


def run_check(
    submission: Submission,
    sandbox: Sandbox,
    logs: Path,
    trials: Mapping[str, Trial],
    *,
    as_json: bool = False,
) -> None:
    """Check a submission and print the findings; UserError if it fails a check that it must pass."""
    with preparing(console):
        precompile_for([submission.sensors])
    with telling("playing") as tell:
        findings = list(run_checks(submission, sandbox, logs, trials, tell=tell))
    console.print(_table(submission, findings))
    if as_json:
        print_json(_document(submission, findings, logs))
    for finding in findings:
        _explain(finding)
    broken = sum(finding.verdict == Verdict.BROKEN for finding in findings)
    if broken:
        raise UserError(f"{submission.name} fails {counted(broken, 'check')}; its output is in {logs}")
    console.print(f"{submission.name} may be submitted. Its output is in {logs}.")


def _document(submission: Submission, findings: list[Finding], logs: Path) -> dict[str, object]:
    """Return what ``wildscav check --json`` prints."""
    return {
        "submission": submission.name,
        "version": submission.manifest.version,
        "passed": not any(finding.verdict == Verdict.BROKEN for finding in findings),
        "findings": [asdict(finding) | {"verdict": finding.verdict.value} for finding in findings],
        "logs": str(logs),
    }


def _table(submission: Submission, findings: list[Finding]) -> Table:
    title = f"{submission.name} {submission.manifest.version}"
    table = plain_table(title)
    table.add_column("check", no_wrap=True)
    table.add_column("")
    table.add_column("seen")
    for finding in findings:
        verdict = Text(finding.verdict.value, STYLES[finding.verdict])
        table.add_row(finding.check, verdict, Text(finding.seen))
    return table


def _explain(finding: Finding) -> None:
    """Print how to fix a broken or doubtful rule."""
    if finding.verdict == Verdict.KEPT:
        return
    style = STYLES[finding.verdict]
    console.print(Text.assemble((f"\n{finding.check}: ", style), finding.seen))
    for line in finding.last_lines[-SHOWN_LINES:]:
        console.print(Text(f"  | {line}", "dim"))
    console.print(Text.assemble(("  to fix it: ", "bold"), finding.advice))
