"""The snapshots of a recorded match, as its worker would have sent them."""

from collections.abc import Iterator

from wildscav_engine.record import Record, resimulate
from wildscav_evaluator.matches.snapshots import Happenings, Snapshot


def moments_of(record: Record) -> Iterator[Snapshot]:
    """Yield a snapshot after every step, and one of the start."""
    happenings = None
    for match in resimulate(record):
        if happenings is None:
            happenings = Happenings(match)
        else:
            happenings.note()
        yield happenings.take()
