"""Columns over time: the data of entities that change, which are sent entity by entity."""

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.view.recording.history import History

STEP, MATCH_TIME = "step", "match_time"  # the timelines
NANOSECONDS_PER_FRAME = 1_000_000_000 // FRAMES_PER_SECOND
MAX_CHUNK = 256  # rows of large data (images) in one chunk


class Columns(NamedTuple):
    """The values of one entity at some rows of the history."""

    path: str
    rows: NDArray[np.int64]  # (N,) in ascending order; lists of events may repeat a row
    values: Iterable[Any]  # component columns with one entry per row


def send(recording: rr.RecordingStream, history: History, columns: Columns) -> None:
    """Send the columns of one entity, on both timelines."""
    if len(columns.rows):
        recording.send_columns(columns.path, times(history, columns.rows), columns.values)


def times(history: History, rows: NDArray[np.int64]) -> list[rr.TimeColumn]:
    """Return the time columns of some rows on both timelines."""
    elapsed = (history.frame[rows] * NANOSECONDS_PER_FRAME).astype("timedelta64[ns]")
    return [rr.TimeColumn(STEP, sequence=rows), rr.TimeColumn(MATCH_TIME, duration=elapsed)]


def blocks(count: int) -> Iterator[slice]:
    """Yield slices that split large columns into chunks, which a viewer can load one by one."""
    for start in range(0, count, MAX_CHUNK):
        yield slice(start, start + MAX_CHUNK)
