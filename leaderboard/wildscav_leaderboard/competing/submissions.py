"""The command ``wildscav team submissions``."""

from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table
from rich.text import Text

from wildscav.cli.shared_options import AsJson
from wildscav.errors import UserError
from wildscav.terminal.console import console, print_json, printable
from wildscav_leaderboard.competing import texts
from wildscav_leaderboard.competing.connected import SeasonUrl, season_client
from wildscav_leaderboard.competing.course import check_end, failure, step, waited

if TYPE_CHECKING:
    from wildscav_leaderboard.api.documents import SubmissionView
    from wildscav_leaderboard.competing.season_client import SeasonClient


def submissions(
    act: Annotated[
        str | None,
        typer.Argument(
            metavar="[ACT] [NUMBER]",
            help="Number of a submission, to see all about it; with an act before it, do that: disable, "
            "restore, keep (so that no later one replaces it), release or cancel.",
            show_default=False,
        ),
    ] = None,
    number: Annotated[int | None, typer.Argument(hidden=True, min=1)] = None,
    team: Annotated[
        str | None, typer.Option(help="Those of this team. Default: yours.", show_default=False)
    ] = None,
    everyone: Annotated[bool, typer.Option("--all", help="Those of all teams.")] = False,
    state: Annotated[
        list[str] | None, typer.Option(help="Only those in this state; may be repeated.", show_default=False)
    ] = None,
    limit: Annotated[int, typer.Option(help="How many, at most; the newest come first.", min=1)] = 20,
    wait: Annotated[
        bool, typer.Option("--wait", help="Wait until the one named takes part; exit with 1 if it failed.")
    ] = False,
    season: SeasonUrl = None,
    as_json: AsJson = False,
) -> None:
    """List your team's submissions, show one, or decide whether it takes part.

    With --json: `submissions`, each with the fields that `wildscav submit` tells; `history`, `progress`
    and `totals` only of one that is asked for by its number.

    With --json, with an act: `submission`.
    """
    if act is not None and act.isascii() and act.isdigit():
        number, act = int(act), None
    if act is not None:
        if number is None:
            raise UserError(f"`wildscav team submissions {act}` needs the number of a submission", 2)
        _act(act, number, season, as_json=as_json)
        return
    if wait and number is None:
        raise UserError("--wait needs the number of a submission", exit_code=2)
    with season_client(season) as client:
        if number is not None:
            found = [waited(client, client.submission(number)) if wait else client.submission(number)]
        else:
            chosen = None if everyone else team or _own_team(client)
            found = client.submissions(limit, team=chosen, states=state)
        url = client.url
    if as_json:
        print_json({"submissions": found})
    if wait:
        check_end(found[0])
    elif number is not None:
        show(found[0], url)
    elif found:
        console.print(_table(found, with_team=everyone))
    else:
        console.print("There are no submissions yet." if state is None else "There are none in this state.")


def _act(act: str, number: int, season: str | None, *, as_json: bool) -> None:
    with season_client(season) as client:
        found = client.act(number, act)
    if as_json:
        print_json({"submission": found})
    where = f" on {', '.join(found.playing)}" if found.playing else ""
    console.print(f"submission {found.id} is {printable(found.state)}{where}{', kept' if found.kept else ''}")


def _own_team(client: "SeasonClient") -> str:
    """Return the name of the user's team."""
    team = client.me().team
    if team is None:
        raise UserError("you are in no team: --all lists the submissions of all teams")
    return team.name


def _table(found: "list[SubmissionView]", *, with_team: bool) -> Table:
    headings = ["submission", "state", "handed in (UTC)", "tracks", "message"]
    table = texts.table_of("", "#", *(["team"] if with_team else []), *headings)
    for one in found:
        what = texts.state(one.state)
        if one.fault is not None:
            what.append(printable(f" ({one.fault})"))
        cells = texts.row(one.id, *([one.team_title] if with_team else []), f"{one.name} {one.version}", what)
        table.add_row(*cells, *texts.row(texts.moment(one.created), ", ".join(one.tracks), one.message))
    return table


def show(one: "SubmissionView", url: str) -> None:
    """Print all about a submission."""
    rows: dict[str, str | Text] = {
        "submission": f"{one.id}: {one.name} {one.version}, for {', '.join(one.tracks)}",
        "team": texts.team(one.team, one.team_title),
        "message": one.message,
        "state": texts.state(one.state),
        "queue": texts.waiting(one),
        "deadline": "" if one.deadline is None else f"{texts.moment(one.deadline)} UTC",
        **{each.track: texts.standing(each) for each in one.progress},
        **{f"{each.track}, all matches": texts.totals(each) for each in one.totals},
        "charged": "" if one.charged else "no",
        "page": f"{url}/submissions/{one.id}",
    }
    console.print(texts.facts(rows))
    for entry in one.history:
        console.print(step(entry))
    console.print(failure(one))
