"""The records that commands take: by path, or by the number or the page of a match of a season."""

import re
from collections.abc import Callable
from importlib.metadata import entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wildscav.errors import UserError

if TYPE_CHECKING:
    from wildscav_engine.record import Record

SOURCES = "wildscav.record_sources"  # entry points: functions such as RecordSource
# The address of a match's page, with one slash where a path has lost the other.
PAGE = re.compile(
    r"(?P<scheme>https?):/+(?P<site>[^?#]+)/matches/(?P<match>\d+)(/(watch|video))?/?([?#].*)?", re.ASCII
)
# Returns the record of a match of a season. Its arguments are the match's number, and the season's address or
# None for the one that the user logged in to.
RecordSource = Callable[[int, str | None], Path]
SeasonOption = Annotated[
    str | None,
    typer.Option(
        help="Address of the season that a number is about. Default: the one that you logged in to last.",
        metavar="URL",
        show_default=False,
    ),
]

LogsOption = Annotated[
    Path | None,
    typer.Option(
        help="Log of an agent, or folder with those of this match: what agents said and drew is shown. "
        "Default: those that an evaluation has put beside the record.",
        show_default=False,
    ),
]


def resolve_record(record: Path, season: str | None) -> Path:
    """Return the path of a record: as it was named, or of the match that has this number or page.

    Raises:
        UserError: The number is of no match, nothing can ask for it, or there is a season but no number.
    """
    text = str(record)
    if page := PAGE.fullmatch(text):
        if season is not None:
            raise UserError("--season is for the number of a match, and this address names one", exit_code=2)
        text, season = page["match"], f"{page['scheme']}://{page['site']}"
    elif record.exists() or not (text.isascii() and text.isdigit()):
        if season is not None:
            raise UserError("--season is for the number of a match", exit_code=2)
        return record
    for point in entry_points(group=SOURCES):
        source: RecordSource = point.load()
        return source(int(text), season)
    raise UserError(
        f"match {text} is of a season: install what asks for it: pip install 'wildscav[leaderboard]'"
    )


def read_of_seat(record: Path, option: str, seat: int | None) -> "Record":
    """Read a record, or raise a UserError if that fails or its match has no such seat."""
    from wildscav_engine.record import RecordError, read_record

    try:
        played = read_record(record)
    except RecordError as error:
        raise UserError(str(error)) from None
    if seat is not None and seat >= len(played.names):
        raise UserError(f"{option} is {seat}; the match has seats 0 to {len(played.names) - 1}", exit_code=2)
    return played
