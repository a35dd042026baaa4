"""The command ``wildscav season export``."""

from pathlib import Path
from typing import Annotated

import typer

from wildscav.terminal.console import command, console, counted
from wildscav_leaderboard.cli.season.folder_argument import SeasonFolder


def export(
    folder: SeasonFolder,
    out: Annotated[
        Path,
        typer.Argument(help="The folder to write, which must be new.", metavar="OUT", show_default=False),
    ],
) -> None:
    """Write what is published of a season into a folder: boards, matches and records, for anyone to audit."""
    from wildscav_leaderboard.publishing.export import export as run
    from wildscav_leaderboard.seasons.folder import Season
    from wildscav_leaderboard.seasons.own_database import opened

    season = Season.open(folder)
    with opened(season) as database:
        made = run(season, database, out)
    hidden = f"; {made.hidden:,} more are still hidden" if made.hidden else ""
    console.print(
        f"{counted(made.boards, 'board')}, {counted(made.matches, 'match')}, "
        f"{counted(made.records, 'record')}{hidden}",
        highlight=False,
    )
    console.print(f"exported to {made.folder}", soft_wrap=True, highlight=False)
    console.print(f"check it    {command('wildscav')} audit {out}", soft_wrap=True, highlight=False)
