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
from wildscav_stage.scene.map_file import centimetres

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
                points=centimetres(note.points).tolist(),
                value=note.value,
            )
            for note in sorted(notes, key=lambda note: note.step)
        ]
    )


def notes_beside(record: Path, played: Record, logs: Path | None = None) -> list[Note]:
    """Return what the agents of a recorded match have said and drawn, by their logs, in the order of steps.

    Args:
        record: The file of the record.
        played: The record.
        logs: A log, or a folder with those of this match alone; None for those that an evaluation or
            ``wildscav mcp`` has put beside the record, if there are some.

    Raises:
        UserError: A log that was asked for cannot be read, or does not say by its name of which seat it is.
    """
    if logs is None:
        named = re.compile(rf"{re.escape(record.stem)}(\.seat-\d+)?\.log")
        places = {record.parent.parent / LOGS, record.parent}
        found = [log for place in places for log in place.glob("*.log") if named.fullmatch(log.name)]
        seats = {log: seat for log in found if (seat := _seat_of(log, played)) is not None}
    else:
        seats = {log: _known(log, played) for log in (logs.glob("*.log") if logs.is_dir() else [logs])}
    notes = [note for log, seat in seats.items() for note in notes_in(log, seat)]
    return sorted(
        (note for note in notes if note.step < played.steps), key=lambda note: (note.step, note.seat)
    )


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


def _seat_of(log: Path, played: Record) -> int | None:
    """Return the seat of a log, by its name, or because no other seat has a log; None if it is none's."""
    named, own = SEAT.fullmatch(log.name), _seats_with_agents(played)
    seat = int(named["last"] or named["first"]) if named else own[0] if len(own) == 1 else None
    return seat if seat in own else None


def _seats_with_agents(played: Record) -> list[int]:
    return [number for number, filled_by in enumerate(played.spec.seats) if filled_by == SUBMISSION]


def _known(log: Path, played: Record) -> int:
    seat = _seat_of(log, played)
    if seat is None:
        own = ", ".join(map(str, _seats_with_agents(played))) or "none"
        raise UserError(
            f"{log}: its name must say of which seat it is, such as 0-{log.stem}.log; "
            f"those with an agent are {own}"
        )
    return seat
