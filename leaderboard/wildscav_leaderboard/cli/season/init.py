"""The command ``wildscav season init``."""

from typing import Annotated

import typer

from wildscav.terminal.console import command, console
from wildscav_leaderboard.cli.season.folder_argument import SeasonFolder


def init(
    folder: SeasonFolder,
    name: Annotated[
        str | None, typer.Option(help="Short name of the season; the folder's name if not given.")
    ] = None,
    title: Annotated[str | None, typer.Option(help="Title, as people read it.")] = None,
    days: Annotated[int, typer.Option(help="How long it is open.", min=1, max=3650)] = 30,
) -> None:
    """Make a season's folder: commented settings, and secret seeds with their public commitments."""
    from wildscav_leaderboard.seasons.initial_files import make_season_folder

    commitment, final = make_season_folder(folder, name, title, days)
    console.print(f"season     {folder}", soft_wrap=True, highlight=False)
    console.print(
        f"settings   {folder / 'season.toml'}: read and change them before it opens", soft_wrap=True
    )
    for what, value in (("commitment", commitment), ("final", final)):
        console.print(f"{what:10} {value}", soft_wrap=True, highlight=False)
    console.print("           the commitments are to be published, and the secrets kept", soft_wrap=True)
    console.print(f"start it   {command('wildscav')} season serve {folder}", soft_wrap=True)
