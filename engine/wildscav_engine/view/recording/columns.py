"""Columns over time: how everything that changes is sent, an entity at once."""

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.view.recording.history import History

STEP, MATCH_TIME = "step", "match_time"  # the time lines
NANOSECONDS_A_FRAME = 1_000_000_000 // FRAMES_PER_SECOND
LONGEST = 256  # rows of heavy data (images) in one chunk


class Columns(NamedTuple):
    """The values of one entity at some rows of the history."""

    path: str
    rows: NDArray[np.int64]  # (N,) in ascending order; an event list may repeat one
    values: Iterable[Any]  # component columns, one entry a row


def send(recording: rr.RecordingStream, history: History, columns: Columns) -> None:
    """Write one entity's columns, on both time lines."""
    if len(columns.rows):
        recording.send_columns(columns.path, times(history, columns.rows), columns.values)


def times(history: History, rows: NDArray[np.int64]) -> list[rr.TimeColumn]:
    """Return the two time columns of some rows."""
    elapsed = (history.frame[rows] * NANOSECONDS_A_FRAME).astype("timedelta64[ns]")
    return [rr.TimeColumn(STEP, sequence=rows), rr.TimeColumn(MATCH_TIME, duration=elapsed)]


def blocks(count: int) -> Iterator[slice]:
    """Yield slices that cut heavy columns into chunks which a viewer can load one by one."""
    for start in range(0, count, LONGEST):
        yield slice(start, start + LONGEST)
