"""The season that a command is about: the argument that names its folder, and its opening."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from wildscav_leaderboard.database.connection import Database
    from wildscav_leaderboard.seasons.folder import Season

SeasonFolder = Annotated[Path, typer.Argument(help="The season's folder.", metavar="DIR", show_default=False)]


@contextmanager
def opened(folder: Path, *, any_version: bool = False) -> "Iterator[tuple[Season, Database]]":
    """Give a season and its database. See ``own_database.opened``."""
    from wildscav_leaderboard.seasons import own_database
    from wildscav_leaderboard.seasons.folder import Season

    season = Season.open(folder)
    with own_database.opened(season, any_version=any_version) as database:
        yield season, database
