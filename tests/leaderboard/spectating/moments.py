"""The snapshots of a recorded match, as its worker would have sent them."""

from collections.abc import Iterator

from wildscav_engine.record import Record, resimulate
from wildscav_evaluator.matches.snapshots import Notes, Snapshot


def moments_of(record: Record) -> Iterator[Snapshot]:
    """Yield a snapshot after every step, and one of the start."""
    notes = None
    for match in resimulate(record):
        if notes is None:
            notes = Notes(match)
        else:
            notes.note()
        yield notes.take()
