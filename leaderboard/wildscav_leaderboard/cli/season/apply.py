"""The command ``wildscav season apply``."""

from datetime import UTC, datetime
from typing import Annotated

import typer

from wildscav.terminal.console import console
from wildscav_leaderboard.cli.season.folder_argument import SeasonFolder


def apply(
    folder: SeasonFolder, yes: Annotated[bool, typer.Option("--yes", help="Do not ask.")] = False
) -> None:
    """Bring changed rules into force: a new edition of each track that they concern, judged again.

    It shows first what that costs. Results of the edition before stay on a board of their own. A season that
    runs goes on under the new edition at once.
    """
    from wildscav_leaderboard.cli.season.acts import command_line
    from wildscav_leaderboard.conductor.editions import apply_editions, edition_changes
    from wildscav_leaderboard.seasons.folder import Season
    from wildscav_leaderboard.seasons.own_database import opened

    season = Season.open(folder)
    with opened(season) as database:
        with database.reading() as session:
            changes = edition_changes(session, season)
        for change in changes:
            console.print(change.text, soft_wrap=True, highlight=False, markup=False)
        if changes and not yes:
            typer.confirm("Bring this into force?", abort=True)
        with database.writing() as session:
            apply_editions(session, season, command_line(), datetime.now(UTC))
        console.print("the new rules are in force", soft_wrap=True)
