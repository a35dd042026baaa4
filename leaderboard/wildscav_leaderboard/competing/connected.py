"""The season that a command talks to: the one named, or the one that the user logged in to last."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated

import typer

from wildscav.errors import UserError
from wildscav.terminal.suggestions import did_you_mean

if TYPE_CHECKING:
    from wildscav_leaderboard.competing.season_client import SeasonClient

SEASON_VARIABLE, TOKEN_VARIABLE = "WILDSCAV_SEASON", "WILDSCAV_ACCOUNT_TOKEN"
LATEST = "latest"  # in place of an address: the season that is meant where none is named
SeasonUrl = Annotated[
    str | None,
    typer.Option(
        "--season",
        help="Address of the season. Default: the one that you logged in to last.",
        metavar="URL",
        envvar=SEASON_VARIABLE,
        show_default=False,
    ),
]


@contextmanager
def season_client(named: str | None) -> "Iterator[SeasonClient]":
    """Give a client of a season, as the account that is logged in there.

    Args:
        named: The season's address; None or latest for the one in WILDSCAV_SEASON, or of the latest login.

    Raises:
        UserError: No season is named, and nobody is logged in.
    """
    from wildscav_leaderboard.competing.connection import Connection, UnreachableError
    from wildscav_leaderboard.competing.season_client import SeasonClient

    url, token = chosen(named)
    with Connection(url, token) as connection:
        try:
            yield SeasonClient(connection)
        except UnreachableError as error:
            raise UnreachableError(f"{error}{did_you_mean(named or '', (LATEST,))}") from None


def chosen(named: str | None) -> tuple[str, str | None]:
    """Return the address of the season that is meant, and the user's token there, if there is one.

    Raises:
        UserError: No season is named, and nobody is logged in.
    """
    from wildscav_leaderboard.competing.connection import season_url
    from wildscav_leaderboard.competing.logins import Logins

    logins = Logins.read()
    if named in (None, "", LATEST):
        named = os.environ.get(SEASON_VARIABLE)
    url = season_url(named) if named else logins.current
    if url is None:
        raise UserError("you are logged in to no season: `wildscav login URL`")
    stored = logins.seasons.get(url)
    return url, os.environ.get(TOKEN_VARIABLE) or (None if stored is None else stored.token)
