"""The command ``wildscav season`` and its subcommands."""

from typing import Any

import typer

from wildscav.cli.main import Commands
from wildscav_leaderboard.cli.season.demo import demo
from wildscav_leaderboard.cli.season.finalize import finalize
from wildscav_leaderboard.cli.season.folders import backup, check, export, init, restore
from wildscav_leaderboard.cli.season.running import apply, serve, status


class SeasonCommands(Commands):
    """All commands; those of the acts, which load all of a season's code, are made when they are needed."""

    def _with_acts(self) -> None:
        from wildscav_leaderboard.cli.season.acts import act_commands

        self.commands.update(typer.main.get_command(act_commands()).commands)  # type: ignore[attr-defined]

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of all commands."""
        self._with_acts()
        return super().list_commands(ctx)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a command; None if there is none of this name."""
        if cmd_name not in self.commands:
            self._with_acts()
        return super().get_command(ctx, cmd_name)


app = typer.Typer(
    name="season",
    cls=SeasonCommands,
    help="Run a season: competitors submit agents, which are played, rated and shown on boards.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
for function in (demo, init, serve, status, apply, finalize, export, backup, restore, check):
    app.command(function.__name__)(function)
