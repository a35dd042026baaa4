"""Replays: a record played again into a Rerun recording."""

from pathlib import Path
from threading import Lock

from wildscav_engine.record import Record, resimulate
from wildscav_engine.specs.match_spec import SUBMISSION
from wildscav_engine.storage.files import write_whole
from wildscav_engine.view.recording.history import collect

# Rerun tells recordings of one process apart by their ids, and those of a record are always the same.
RENDERING = Lock()


class ViewError(Exception):
    """A replay cannot be made; the message is one clear line."""


def write_replay(record: Record, path: Path, *, follow: int | None = None, images: bool = True) -> None:
    """Render a record as a Rerun file that shows the match at once when it is opened.

    The file is there whole or not at all. Rerun keeps a few idle threads for every recording that a process
    ever made: a server that renders without end should do so in processes that end.

    Args:
        record: The record; it is re-simulated here.
        path: Where to write, usually ``*.rrd``.
        follow: The seat that the cameras follow; by default the first that a submission fills.
        images: Whether the followed agent's depth maps and pictures are in the file.

    Raises:
        ViewError: Rerun is not installed, or there is no such seat.
        OSError: The file cannot be written.
    """
    write_whole(path, rendered(record, follow=follow, images=images))


def rendered(record: Record, *, follow: int | None = None, images: bool = True) -> bytes:
    """Render a record as the content of a Rerun file; see ``write_replay``.

    Raises:
        ViewError: Rerun is not installed, or there is no such seat.
    """
    seat = _followed(record) if follow is None else follow
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
    match, history = collect(resimulate(record), len(record.actions), seat if images else None)
    with RENDERING:
        return render(record, match.game_map, history, seat)


def _followed(record: Record) -> int:
    seats = record.spec.seats
    return seats.index(SUBMISSION) if SUBMISSION in seats else 0
