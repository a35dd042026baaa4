"""What ``wildscav verify`` does and shows for a season."""

from dataclasses import asdict

from rich.text import Text

from wildscav.errors import UserError
from wildscav.terminal.console import console, print_json, progress_bar
from wildscav.terminal.tables import FittingTable
from wildscav_evaluator.cache import cache_folder
from wildscav_evaluator.cli.sessions.playing import raise_errors
from wildscav_evaluator.executors import Executor
from wildscav_leaderboard.auditing.audit import Audit
from wildscav_leaderboard.auditing.record_checks import Wanted
from wildscav_leaderboard.auditing.report import Report

SHOWN = 20  # findings, at most


def run_audit(
    place: str,
    executor: Executor,
    track: str | None = None,
    commitment: str | None = None,
    download: int | None = None,
    resimulate: int | None = None,
    *,
    as_json: bool = False,
) -> None:
    """Audit a season, and show what was checked.

    Args:
        track: The only track to check; None for all.
        commitment: The commitment of the season's secret, as somebody noted it beforehand.
        download: How many records of each track to download; None for all.
        resimulate: How many of these to play again; None for all.
        as_json: Whether to print a JSON document instead of a table.

    Raises:
        UserError: It cannot be read; or, after everything was shown, something is wrong.
    """
    noted = None if commitment is None else commitment.strip().lower()
    wanted = Wanted(track, download, resimulate, noted)
    report = _audited(place, wanted, executor)
    if as_json:
        print_json(_document(report))
    else:
        _show(report)
    found = [str(one) for one in report.findings]
    if len(found) > SHOWN:
        found[SHOWN:] = [f"and {len(found) - SHOWN:,} more findings (--json lists all)"]
    raise_errors(found)
    if as_json:
        return
    if any(check.checked for check in report.checks):
        console.print("everything that was checked is right")
    else:
        console.print("nothing could be checked yet: try again when the secrets are published")


def _audited(place: str, wanted: Wanted, executor: Executor) -> Report:
    with progress_bar() as progress:
        task = progress.add_task("reading the season", total=None)

        def show(what: str, done: int, total: int) -> None:
            progress.update(task, description=what, completed=done, total=total or None)

        try:
            return Audit(wanted, executor, cache_folder("audits"), show).run(place)
        except KeyboardInterrupt:
            raise UserError("interrupted; the same command goes on with what was downloaded", 130) from None


def _document(report: Report) -> dict[str, object]:
    return {
        "season": report.season,
        "address": report.address,
        "commitments": report.commitments,
        "holds": report.holds,
        "checks": [
            {
                "track": check.track,
                "what": check.what,
                "checked": check.checked,
                "unchecked": [{"count": count, "why": why} for why, count in check.unchecked.items()],
            }
            for check in report.checks
        ],
        "findings": [asdict(finding) for finding in report.findings],
    }


def _show(report: Report) -> None:
    """Print how much was checked, and below it what was not and why."""
    table = FittingTable(f"{report.season}, as {report.address} publishes it")
    for name in ("track", "what"):
        table.add_column(name)
    for name in ("checked", "not\nchecked"):
        table.add_column(name, justify="right")
    skipped: dict[str, list[str]] = {}
    for check in report.checks:
        missing = sum(check.unchecked.values())
        cells = (check.track or "", check.what, f"{check.checked:,}", f"{missing:,}" if missing else "")
        table.add_row(*map(Text, cells))
        for why, count in check.unchecked.items():
            place = f"{check.track}, {check.what}" if check.track else check.what
            skipped.setdefault(why, []).append(f"{place} ({count:,})")
    console.print(table)
    for why, what in skipped.items():
        console.print(Text(f"not checked, because {why}: {'; '.join(what)}", "dim"))
    console.print()
