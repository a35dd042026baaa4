"""The command ``wildscav team matches``, and the records of matches for other commands."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table
from rich.text import Text

from wildscav.cli.shared_options import AsJson
from wildscav.errors import UserError, describe
from wildscav.terminal.console import console, error_console, print_json
from wildscav_leaderboard.competing import texts
from wildscav_leaderboard.competing.connected import SeasonUrl, season_client

if TYPE_CHECKING:
    from wildscav_leaderboard.api.documents import MatchView


def matches(
    submission: Annotated[
        int | None,
        typer.Argument(help="Number of a submission. Default: those of all.", min=1, show_default=False),
    ] = None,
    match: Annotated[
        int | None, typer.Option(help="Show the seats of this match.", min=1, show_default=False)
    ] = None,
    track: Annotated[str | None, typer.Option(help="Only those on this track.", show_default=False)] = None,
    limit: Annotated[int, typer.Option(help="How many, at most; the newest come first.", min=1)] = 20,
    season: SeasonUrl = None,
    as_json: AsJson = False,
) -> None:
    """List the matches of a submission, or of the whole season; or show one match.

    With --json: `matches`: `id`, `kind`, `track`, `number`, `state`, `since`, `created`, `detail`,
    `platform_faults`, `judging`, `superseded` (since when a later judging counts), `winner` (or why there is
    none), `hidden` (why its record is), `unseen` (why its outcome is), `record` (its digest), and `seats`:
    `seat`, `entrant` (in records), `name`, `submission`, `team`, `team_title`, `status`, `fault`, `detail`,
    `metrics`, `place` (on a ladder), and of your own team's `latency_p50`, `latency_p99`, `latency_max` and
    `late_steps`, of each.
    """
    if match is not None and (submission is not None or track is not None):
        raise UserError("--match shows one match: leave out the others", exit_code=2)
    with season_client(season) as client:
        if match is not None:
            found = [client.match(match)]
        else:
            found = client.matches(limit, submission=submission, track=track)
        url = client.url
    if as_json:
        print_json({"matches": found})
    if match is not None:
        _show(found[0], url)
    elif found:
        console.print(_table(found, submission))
    else:
        console.print("There are no matches yet.")


def _table(found: "list[MatchView]", submission: int | None) -> Table:
    table = texts.table_of("", "match#", "track", "state", "since (UTC)", "entrants", "winner", "outcome")
    for one in found:
        own = [seat for seat in one.seats if submission is not None and seat.submission == submission]
        outcomes = dict.fromkeys(texts.outcome(one, seat) for seat in own or one.seats[:1])
        entrants = ", ".join(dict.fromkeys(seat.who for seat in one.seats))
        since = texts.minute(one.since) if one.since else ""
        cells = (one.id, one.track, texts.state(one.state), since, entrants, one.winner or "")
        table.add_row(*texts.row(*cells, ", ".join(filter(None, outcomes))))
    return table


def _show(one: "MatchView", url: str) -> None:
    rows: dict[str, str | Text] = {
        "match": f"{one.id}: {one.track}, {one.kind}",
        "state": texts.state(one.state),
        "since": f"{texts.moment(one.since)} UTC" if one.since else "",
        "winner": one.winner or "",
        "what happened": one.detail,
        "hidden": one.hidden or one.unseen or "",
        "page": f"{url}/matches/{one.id}",
        "watch it": "" if one.hidden else f"wildscav replay {one.id}",
    }
    console.print(texts.facts(rows))
    table = texts.table_of("", "seat#", "entrant", "team", "status", "fault", "figures", "p99#")
    for seat in one.seats:
        latency = "" if seat.latency_p99 is None else f"{1000.0 * seat.latency_p99:.1f} ms"
        why = ": ".join(filter(None, (seat.fault, seat.detail)))
        cells = (seat.seat, seat.name, seat.team_title or "", seat.status or "", why)
        table.add_row(*texts.row(*cells, texts.figures(seat.metrics), latency))
    console.print(table)


def fetched_record(match: int, season: str | None) -> Path:
    """Return the path of a match's record, which is downloaded into the current folder unless it is there.

    Args:
        season: Address of the season; None for the one of the latest login.

    Raises:
        UserError: There is no such match, its record is hidden, or it cannot be stored.
    """
    from wildscav_leaderboard.competing.season_client import is_stored

    path = Path(f"match-{match}.wsr")
    with season_client(season) as client:
        found = client.match(match)
        if found.record is None:
            raise UserError(f"match {match} has no record yet: it is {found.state}")
        try:
            stored = is_stored(path, found.record)
        except OSError as error:
            raise UserError(describe(error)) from None
        if not stored and path.exists():
            raise UserError(f"{path} is another file, which the record would overwrite: move it away")
        if not stored:
            with error_console.status("downloading the record"):
                client.download_record(match, found.record, path)
            console.print(f"{path}: the record of match {match}")
    return path
