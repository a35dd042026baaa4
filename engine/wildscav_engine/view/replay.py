"""Replays: re-simulated records as Rerun recordings."""

from collections.abc import Sequence
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING

from wildscav_engine.record import Record, resimulate
from wildscav_engine.specs.match_spec import SUBMISSION
from wildscav_engine.storage.files import write_whole
from wildscav_engine.view.recording.history import collect_history

if TYPE_CHECKING:
    from wildscav_engine.view.recording.agent_notes import Note

# Rerun distinguishes the recordings of a process by their ids, and every replay of a record has the same id.
RENDERING = Lock()


class ViewError(Exception):
    """A replay cannot be rendered; the message is one line that says why."""


def write_replay(record: Record, path: Path, *, follow: int | None = None, images: bool = True) -> None:
    """Render a record as a Rerun file, which shows the match as soon as it is opened.

    The file is written atomically. Rerun keeps a few idle threads for each recording that a process has ever
    made, so long-running servers should render in short-lived processes.

    Args:
        record: The record, which is re-simulated.
        path: The file to write, usually ``*.rrd``.
        follow: The seat that the cameras follow; by default the first that a submission fills.
        images: Whether to include the depth maps and camera images of the followed agent.

    Raises:
        ViewError: Rerun is not installed, or there is no such seat.
        OSError: The file cannot be written.
    """
    write_whole(path, rendered(record, follow=follow, images=images))


def rendered(
    record: Record, *, follow: int | None = None, images: bool = True, notes: "Sequence[Note]" = ()
) -> bytes:
    """Render a record as the content of a Rerun file; see ``write_replay``.

    Args:
        notes: What agents said and drew, in the order of their steps; see ``notes.py``.

    Raises:
        ViewError: Rerun is not installed, or there is no such seat.
    """
    seats = record.spec.seats
    seat = follow if follow is not None else seats.index(SUBMISSION) if SUBMISSION in seats else 0
    if not 0 <= seat < len(record.names):
        raise ViewError(
            f"there is no seat {seat} to follow: the record has seats 0 to {len(record.names) - 1}"
        )
    try:
        from wildscav_engine.view.scene import render
    except ImportError as error:
        if (error.name or "").split(".")[0] != "rerun":
            raise
        raise ViewError("replays need Rerun: pip install 'wildscav[view]'") from error
    match, history = collect_history(resimulate(record), len(record.actions), seat if images else None)
    with RENDERING:
        return render(record, match.game_map, history, seat, notes)
