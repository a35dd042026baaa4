"""What agents said and drew in a match, as it is sent: its logs are read once, and not for each who asks."""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from wildscav_stage.scene.notes import notes_in, shown_notes

KEPT = 64  # answers
MOST = 10_000  # notes of a seat; the longest matches of our tracks have 3,000 steps


class SeenLog(NamedTuple):
    """The log of a seat, of which somebody may see notes."""

    path: Path
    seat: int
    everything: bool  # or else what its team made public


def sent_notes(logs: Sequence[SeenLog], frames_per_action: int) -> Iterator[bytes]:
    """Yield the notes in some logs as a document (``Notes``), compressed."""
    found = [(log, log.path.stat()) for log in logs if log.path.is_file()]
    versions = tuple((log, state.st_mtime_ns, state.st_size) for log, state in found)
    yield _packed(versions, frames_per_action)


@lru_cache(KEPT)
def _packed(logs: tuple[tuple[SeenLog, int, int], ...], frames_per_action: int) -> bytes:
    """Return the notes in some logs, of which the times and sizes are given, so that new ones are read."""
    notes = [
        note
        for log, _time, _size in logs
        for note in notes_in(log.path, log.seat, MOST)
        if note.public or log.everything
    ]
    return shown_notes(notes, frames_per_action).compressed()
