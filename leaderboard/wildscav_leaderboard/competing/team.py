"""The command ``wildscav team`` and its subcommands."""

from typing import TYPE_CHECKING, Annotated

import typer

from wildscav.cli.main import Commands
from wildscav.cli.shared_options import AsJson
from wildscav.errors import UserError
from wildscav.terminal.console import console, print_json
from wildscav_leaderboard.competing import texts
from wildscav_leaderboard.competing.connected import SeasonUrl, season_client

if TYPE_CHECKING:
    from wildscav_leaderboard.api.documents import QuotaView, TeamView

app = typer.Typer(
    name="team",
    cls=Commands,
    help="Your team in a season: its members, submissions, matches and logs.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


@app.command()
def create(
    name: Annotated[str, typer.Argument(help="Its name: 2 to 40 of a-z, 0-9 and -.", show_default=False)],
    title: Annotated[str, typer.Option(help="Its title, as boards show it.", show_default=False)] = "",
    season: SeasonUrl = None,
    as_json: AsJson = False,
) -> None:
    """Make a team, and print the key with which teammates join it.

    With --json: `team`: `name`, `title`, `created`, `disqualified` (why), `members`; and `key`, for
    teammates.
    """
    with season_client(season) as client:
        made = client.make_team(name, title)
    if as_json:
        print_json(made)
    texts.say(f"team {made.team.name}")
    texts.say(f"key  {made.key}")
    texts.say("     (for teammates: wildscav team join KEY; shown this once)")


@app.command()
def join(
    key: Annotated[str, typer.Argument(help="Key of a team, from a member of it.", show_default=False)],
    season: SeasonUrl = None,
    as_json: AsJson = False,
) -> None:
    """Join a team with its key.

    With --json: `team`.
    """
    with season_client(season) as client:
        team = client.join_team(key)
    if as_json:
        print_json({"team": team})
    texts.say(f"you are a member of {team.name}: {', '.join(team.members)}")


@app.command()
def leave(season: SeasonUrl = None, as_json: AsJson = False) -> None:
    """Leave your team. What it submitted stays.

    With --json: `left`, the team's name.
    """
    with season_client(season) as client:
        team = client.me().team
        client.leave_team()
    left = "" if team is None else team.name
    if as_json:
        print_json({"left": left})
    texts.say(f"you left {left}")


@app.command()
def show(
    name: Annotated[
        str | None, typer.Argument(help="Name of a team. Default: yours.", show_default=False)
    ] = None,
    season: SeasonUrl = None,
    as_json: AsJson = False,
) -> None:
    """Show a team: its members, and what is left of your own team's quota.

    With --json: `team`; for your own also `quota`: `per_day`, `used_today`, `left_today`, `resets`,
    `active_per_track`, `active`, `archive` (MiB that one may have).
    """
    with season_client(season) as client:
        quota: QuotaView | None = None
        if name is None:
            account = client.me()
            quota = account.quota
            if account.team is None:
                raise UserError("you are in no team: `wildscav team create NAME` or `wildscav team join KEY`")
            team = account.team
        else:
            team = client.team(name)
    if as_json:
        print_json({"team": team, "quota": quota})
    _show(team, quota)


@app.command()
def key(season: SeasonUrl = None, as_json: AsJson = False) -> None:
    """Print another key for teammates; the old one is worth nothing from now on.

    With --json: `key`.
    """
    with season_client(season) as client:
        made = client.new_team_key()
    if as_json:
        print_json({"key": made})
    texts.say(made)


def _show(team: "TeamView", quota: "QuotaView | None") -> None:
    active = {} if quota is None else quota.active
    rows = {
        "team": texts.team(team.name, team.title),
        "members": ", ".join(team.members),
        "disqualified": team.disqualified or "",
        "quota": "" if quota is None else texts.quota(quota),
        "active": ", ".join(f"{count} on {track}" for track, count in active.items()),
    }
    console.print(texts.facts(rows))
