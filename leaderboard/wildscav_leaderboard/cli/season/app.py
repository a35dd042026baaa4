"""The command ``wildscav season`` and its subcommands."""

import typer

from wildscav_leaderboard.cli.season import acts
from wildscav_leaderboard.cli.season.apply import apply
from wildscav_leaderboard.cli.season.backups import backup, check, restore
from wildscav_leaderboard.cli.season.demo import demo
from wildscav_leaderboard.cli.season.export import export
from wildscav_leaderboard.cli.season.finalize import finalize
from wildscav_leaderboard.cli.season.init import init
from wildscav_leaderboard.cli.season.serve import serve
from wildscav_leaderboard.cli.season.status import status

app = typer.Typer(
    help="Run a season: competitors submit agents, which are played, rated and shown on boards.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
COMMANDS = (
    *(demo, init, serve, status, acts.invite, acts.organizer, acts.announce),
    *(acts.password, acts.disable, acts.enable),
    *(acts.pause, acts.resume, acts.rerun, acts.disqualify, acts.freeze),
    *(apply, finalize, export, backup, restore, check),
)
for function in COMMANDS:
    app.command(function.__name__)(function)
