"""The program that renders files from a record, in a process of its own: see ``render_cache.py``.

It prints nothing but, if it fails, one line that says why.
"""

import gzip
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

from wildscav.errors import UserError, describe
from wildscav.system.worker_processes import become_worker
from wildscav_engine.record import RecordError, read_record
from wildscav_engine.storage.files import write_whole
from wildscav_engine.view import ViewError, write_replay
from wildscav_leaderboard.spectating.film import write_match_poster, write_match_video
from wildscav_leaderboard.spectating.overview import overview_of_file
from wildscav_leaderboard.spectating.render_cache import PROGRESS
from wildscav_leaderboard.spectating.trails import trails_of_file

NICENESS = 10  # pages are answered first
TOLD_EVERY = 0.5  # s


def render_trails(record: Path, target: Path) -> None:
    """Write the document of a match's trails, compressed."""
    document = trails_of_file(record).model_dump_json().encode()
    write_whole(target, gzip.compress(document, 6, mtime=0))


def render_overview(record: Path, target: Path) -> None:
    """Write the picture of a match's map."""
    write_whole(target, overview_of_file(record))


def render_replay(record: Path, target: Path) -> None:
    """Write the replay of a match for Rerun."""
    write_replay(read_record(record), target)


def render_video(record: Path, target: Path) -> None:
    """Write the video of a match, and meanwhile how far it is."""
    told = 0.0

    def report(done: int, count: int) -> None:
        nonlocal told
        if time.monotonic() - told >= TOLD_EVERY:
            told = time.monotonic()
            write_whole(target.with_name(PROGRESS), str(100 * done // count).encode())

    write_match_video(record, target, report)


RENDERERS: dict[str, Callable[[Path, Path], None]] = {
    "trails": render_trails,
    "overview": render_overview,
    "replay": render_replay,
    "poster": write_match_poster,
    "video": render_video,
}


def main() -> None:
    """Render what the arguments name: the record, the parent's id, and ``product=file`` for each file."""
    record, parent, *wanted = sys.argv[1:]
    become_worker(int(parent))
    os.nice(NICENESS)
    try:
        for product, _, target in (each.partition("=") for each in wanted):
            RENDERERS[product](Path(record), Path(target))
    except OSError as error:
        raise SystemExit(describe(error)) from None
    except (UserError, RecordError, ViewError) as error:
        raise SystemExit(str(error)) from None


if __name__ == "__main__":
    main()
