"""The commands for a season that runs: ``serve``, ``status`` and ``apply``."""

from collections.abc import Callable
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table
from rich.text import Text

from wildscav.cli.shared_options import AsJson
from wildscav.terminal.console import console, print_json
from wildscav_leaderboard.cli.season.folders import SeasonFolder, opened
from wildscav_leaderboard.competing.texts import waits_for

if TYPE_CHECKING:
    from wildscav_leaderboard.organizing.status import AttemptView, StatusView
    from wildscav_leaderboard.seasons.folder import Season


def serve(
    folder: SeasonFolder,
    web: Annotated[bool, typer.Option("--web", help="Only the web site and the API.")] = False,
    conductor: Annotated[
        bool, typer.Option("--conductor", help="Only the conductor, which plays the matches.")
    ] = False,
    host: Annotated[str | None, typer.Option(help="Address to listen on.")] = None,
    port: Annotated[int | None, typer.Option(help="Port to listen on.", min=0, max=65_535)] = None,
    metrics_port: Annotated[
        int | None, typer.Option(help="Serve Prometheus metrics to this machine.", min=0, max=65_535)
    ] = None,
    log_format: Annotated[str, typer.Option(help="text or json.")] = "text",
) -> None:
    """Run a season: the web site with its API, and the conductor that has matches played."""
    from wildscav.errors import UserError
    from wildscav.system.ports import check_port
    from wildscav_leaderboard.seasons.folder import Season

    if log_format not in ("text", "json"):
        raise UserError(f"--log-format is {log_format!r}, must be text or json", exit_code=2)
    is_web = web or not conductor
    chosen = {"host": host, "port": port, "metrics_port": metrics_port}
    if not is_web and any(value is not None for value in chosen.values()):
        raise UserError(
            "--host, --port and --metrics-port belong to the web site, not --conductor", exit_code=2
        )
    season = Season.open(folder)
    changed = season.settings.web.model_copy(
        update={name: value for name, value in chosen.items() if value is not None}
    )
    if is_web:  # before all that takes time
        changed = changed.model_copy(update={"port": check_port(changed.host, changed.port)})

    from wildscav_leaderboard.hosting.serve import CONDUCTOR, WEB, check_certificate
    from wildscav_leaderboard.hosting.serve import serve as run
    from wildscav_leaderboard.organizing.checking import check_rules

    if is_web:
        check_certificate(season)
    season = Season(season.folder, season.settings.model_copy(update={"web": changed}))
    for line in check_rules(season):
        console.print(line)
    parts = tuple(name for name, wanted in ((WEB, is_web), (CONDUCTOR, conductor or not web)) if wanted)
    announced = _announced(season) if is_web else lambda: None
    run(season, parts, "json" if log_format == "json" else "text", announced)


def _announced(season: "Season") -> Callable[[], None]:
    """Return what prints the season's address once its web process listens. Called again and again."""
    from wildscav.system.ports import is_listening

    web, is_said = season.settings.web, False

    def look() -> None:
        nonlocal is_said
        if not is_said and is_listening(web.host, web.port):
            is_said = True
            console.print(f"{season.settings.title}: {web.address} (Ctrl-C ends it)")

    return look


SHOWN_FAULTS = 10


def status(folder: SeasonFolder, as_json: AsJson = False) -> None:
    """Show how a season is doing: what waits, what is played, and what went wrong.

    With --json: `conductor` (who conducts), `sandbox`, `executor`, `at_once` (matches), `phase` (not open
    yet, open, closed, being decided or over), `frozen` (public boards), `paused` (why), `teams`,
    `submissions` and `matches` (by state), `missing` (teams without whom a ladder makes no matches, by
    track), `changes` (of the rules, not in force yet), `failed` (why nothing can be played); `attempts` that
    have not ended and `faults` of the platform in the last day: `id`, `kind`, `number`, `epoch`, `started`,
    `deadline`, `begun`, `match_id`, `submission_id`, `ended`, `outcome`, `detail` of each.
    """
    from wildscav_leaderboard.organizing.status import status as found

    with opened(folder) as (season, database), database.reading() as session:
        one = found(session, season, datetime.now(UTC))
    if as_json:
        print_json(one.model_dump())
    console.print(_table(season.settings.title, one))
    if one.faults:
        console.print(_faults(one.faults[:SHOWN_FAULTS]))


def _table(title: str, one: "StatusView") -> Table:
    table = Table("", "", title=Text(title), box=None, show_header=False)
    conducted = one.conductor or "nobody conducts: `wildscav season serve` starts what does"
    where = f"{one.executor}, {one.at_once} at once, sandbox {one.sandbox}" if one.executor else ""
    rows = {
        "season": one.phase + (", public boards frozen" if one.frozen and one.phase != "over" else ""),
        "conductor": conducted,
        "matches are played": where,
        "nothing is played": one.failed or "",
        "paused": one.paused or "no",
        "teams": f"{one.teams:,}",
        "submissions": _counted(one.submissions),
        "matches": _counted(one.matches),
        "waiting": _waiting(one.missing),
        "not in force": "\n".join(one.changes),
        "faults in a day": f"{len(one.faults):,}",
    }
    for name, text in rows.items():
        if text:
            table.add_row(Text(name, "dim"), Text(text))
    return table


def _waiting(missing: dict[str, int]) -> str:
    """Return which ladders can make no match yet."""
    return "; ".join(f"{track}: {waits_for(count)}" for track, count in missing.items())


def _counted(counts: dict[str, int]) -> str:
    return ", ".join(f"{count:,} {state}" for state, count in counts.items()) or "none"


def _faults(faults: "list[AttemptView]") -> Table:
    table = Table(
        "started", "work", "outcome", "what happened", title="the platform's latest faults", box=None
    )
    for one in faults:
        what = f"match {one.match_id}" if one.match_id else f"{one.kind} submission {one.submission_id}"
        table.add_row(f"{one.started:%m-%d %H:%M:%S}", what, one.outcome or "", Text(one.detail))
    return table


def apply(
    folder: SeasonFolder, yes: Annotated[bool, typer.Option("--yes", help="Do not ask.")] = False
) -> None:
    """Bring changed rules into force: a new edition of each track that they concern, judged again.

    It shows first what that costs. Results of the edition before stay on a board of their own. A season that
    runs goes on under the new edition at once, unless `season serve` has to be started again first: with
    another sandbox or model.
    """
    from wildscav_leaderboard.cli.season.acts import command_line
    from wildscav_leaderboard.conductor.editions import apply_editions, edition_changes, why_to_restart
    from wildscav_leaderboard.organizing.checking import entries_without_model

    with opened(folder) as (season, database):
        with database.reading() as session:
            changes = edition_changes(session, season)
            lines = [*(change.text for change in changes), *entries_without_model(session, season)]
        for line in lines:
            console.print(line)
        if changes and not yes:
            typer.confirm("Bring this into force?", abort=True)
        with database.writing() as session:
            apply_editions(session, season, command_line(), datetime.now(UTC))
            restart = why_to_restart(session, season)
    console.print(
        "the new rules are in force" if restart is None else f"the new rules are in force: {restart}"
    )
