"""The names of records in an output folder, which say to which match and submission a record belongs."""

import re
from pathlib import Path
from typing import NamedTuple

from wildscav.errors import UserError
from wildscav_engine.record import SUFFIX, Record
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.output.layout import RECORDS
from wildscav_evaluator.seats import display_names, submission_seats

NAME = re.compile(
    rf"(?P<track>{'|'.join(TRACKS)})-(?P<match>\d{{3,6}})(?:-(?P<submission>[a-z0-9-]{{2,40}}))?{re.escape(SUFFIX)}"
)


class RecordName(NamedTuple):
    """The parts of the name of a record's file."""

    track: str
    match: int  # in the suite or in the tournament
    submission: str | None  # None in a tournament


def record_paths(out: Path) -> list[Path]:
    """Return the records of an output folder; UserError if there are none."""
    paths = sorted((out / RECORDS).glob(f"[!.]*{SUFFIX}"))
    if not paths:
        raise UserError(f"there are no records in {out / RECORDS}: name an evaluation's output folder", 2)
    return paths


def parse_name(path: Path) -> RecordName | None:
    """Return the parts of a record's name; None if it is not a name that evaluations give."""
    match = NAME.fullmatch(path.name)
    return match and RecordName(match["track"], int(match["match"]), match["submission"])


def misnamed(record: Record, name: RecordName) -> str:
    """Return how a record differs from the name of its file; an empty text if it does not."""
    seats = submission_seats(record.spec.seats)
    if not seats and name.submission is not None:
        return "no submission plays in its match"
    if record.spec.track != name.track:
        return f"it is of {record.spec.track}, not of {name.track}"
    if name.submission is None:
        return ""  # the tournament's schedule determines who plays
    expected = display_names(record.spec.seats, [name.submission] * len(seats))
    for seat in seats:
        if record.names[seat] != expected[seat]:
            return f"seat {seat} belongs to {record.names[seat]}, not to {expected[seat]}"
    return "" if record.names == expected else "its seats have other names"
