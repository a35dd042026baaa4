"""The notes of a match's agents: found in their logs, and as a page shows them."""

import re
from collections.abc import Iterable
from itertools import islice
from pathlib import Path
from typing import Final, Literal

from wildscav.errors import UserError
from wildscav.notes import Note, read_notes
from wildscav_engine.record import Record
from wildscav_engine.specs.match_spec import SUBMISSION
from wildscav_stage.scene.document import Part

NOTES_VERSION: Final = 1
LOGS = "logs"  # folder beside that of the records, in the output of an evaluation
LARGEST = 8_000_000  # bytes that are read of a log
# How the logs of a match's seats are called: those of an evaluation, and those of `wildscav play`.
SEAT = re.compile(r"(?:.*\.seat-(?P<last>\d{1,3})|(?P<first>\d{1,3})-.*)\.log")


class NoteShown(Part):
    """A note. It has a text, or a name with points; or a name with a value."""

    frame: int
    seat: int
    text: str = ""
    name: str = ""
    points: tuple[tuple[int, int, int], ...] = ()  # cm: x, height, z
    value: float | None = None


class Notes(Part):
    """All notes of a match that somebody may see, in the order of their frames."""

    version: Literal[1] = NOTES_VERSION
    notes: list[NoteShown]


def shown_notes(notes: Iterable[Note], frames_per_action: int) -> Notes:
    """Return notes as a page shows them."""
    return Notes(
        notes=[
            NoteShown(
                frame=note.step * frames_per_action,
                seat=note.seat,
                text=note.text,
                name=note.name,
                points=tuple((round(100 * x), round(100 * y), round(100 * z)) for x, y, z in note.points),
                value=note.value,
            )
            for note in sorted(notes, key=lambda note: note.step)
        ]
    )


def notes_beside(record: Path, played: Record, logs: Path | None = None) -> list[Note]:
    """Return what the agents of a recorded match have said and drawn, by their logs.

    Args:
        record: The file of the record.
        played: The record.
        logs: A log, or a folder with those of this match alone; None for those that an evaluation or
            ``wildscav mcp`` has put beside the record, if there are some.

    Raises:
        UserError: There is no such file, or a log whose name does not say of which seat it is.
    """
    if logs is None:
        folders, names = (record.parent.parent / LOGS, record.parent), (".log", ".seat-*.log")
        found = sorted(log for place in folders for name in names for log in place.glob(record.stem + name))
    elif logs.is_dir():
        found = sorted(logs.glob("*.log"))
    else:
        found = [logs]
    steps = played.steps
    return [note for log in found for note in notes_in(log, _seat_of(log, played)) if note.step < steps]


def notes_in(log: Path, seat: int, most: int | None = None) -> list[Note]:
    """Return the notes in the log of a seat, the first ones if there are more than ``most``.

    Raises:
        UserError: It cannot be read.
    """
    try:
        with log.open("rb") as file:
            content = file.read(LARGEST)
    except OSError as error:
        raise UserError(f"cannot read {log}: {error.strerror}") from None
    return [*islice(read_notes(content.decode("utf-8", "replace").split("\n"), seat), most)]


def _seat_of(log: Path, played: Record) -> int:
    """Return the seat of a log, by its name, or because no other seat has a log."""
    named, seats = SEAT.fullmatch(log.name), played.spec.seats
    own = [number for number, filled_by in enumerate(seats) if filled_by == SUBMISSION]
    seat = int(named["last"] or named["first"]) if named else own[0] if len(own) == 1 else -1
    if seat not in own:
        raise UserError(
            f"{log}: its name must say of which seat it is, such as 0-{log.stem}.log; "
            f"those with an agent are {', '.join(map(str, own)) or 'none'}"
        )
    return seat
