"""The command ``wildscav team logs``."""

from typing import TYPE_CHECKING, Annotated

import typer
from rich.text import Text

from wildscav.cli.shared_options import AsJson
from wildscav.errors import UserError
from wildscav.terminal.console import LAYOUT, console, print_json, printable
from wildscav_leaderboard.competing.connected import SeasonUrl, season_client

if TYPE_CHECKING:
    from wildscav_leaderboard.competing.season_client import SeasonClient


def logs(
    submission: Annotated[
        int | None, typer.Argument(help="Number of a submission.", min=1, show_default=False)
    ] = None,
    match: Annotated[
        int | None, typer.Option(help="Of this match, in place of a submission.", min=1, show_default=False)
    ] = None,
    seat: Annotated[
        int | None,
        typer.Option(help="Seat of the match. Default: all of your team.", min=0, show_default=False),
    ] = None,
    season: SeasonUrl = None,
    as_json: AsJson = False,
) -> None:
    """Print what your agent printed: in the validation of a submission, or in a match.

    With --json: `logs`: `log`, and `submission`, or `match` and `seat`, of each.
    """
    if (submission is None) == (match is None):
        raise UserError("name a submission, or a match with --match", exit_code=2)
    if seat is not None and match is None:
        raise UserError("--seat is for a match: add --match", exit_code=2)
    with season_client(season) as client:
        if submission is not None:
            found: list[dict[str, int | str]]
            found = [{"submission": submission, "log": client.submission_log(submission)}]
        else:
            found = _of_match(client, match or 0, seat)
    if as_json:
        print_json({"logs": found})
    for one in found:
        if len(found) > 1:
            console.print(Text(f"── seat {one['seat']} ──", "dim"))
        text = printable(str(one["log"]), LAYOUT)
        console.print(Text(text), end="" if text.endswith("\n") else "\n")


def _of_match(client: "SeasonClient", match: int, seat: int | None) -> list[dict[str, int | str]]:
    """Return the logs of one seat, or of all that the user's team has in a match."""
    seats = [seat] if seat is not None else _own_seats(client, match)
    return [{"match": match, "seat": one, "log": client.match_log(match, one)} for one in seats]


def _own_seats(client: "SeasonClient", match: int) -> list[int]:
    """Return the seats whose logs the user may read: those of the user's team, or for organizers, all."""
    me = client.me()
    own = None if me.team is None else me.team.name
    seats = [
        one.seat
        for one in client.match(match).seats
        if one.team is not None and (me.role == "organizer" or one.team == own)
    ]
    if not seats:
        raise UserError(f"your team has no seat in match {match}")
    return seats
