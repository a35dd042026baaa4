"""The program that renders files from a record, in a process of its own: see ``render_cache.py``.

It prints nothing but, if it fails, one line that says why.
"""

import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

from wildscav.errors import UserError, describe
from wildscav.notes import Note
from wildscav.system.worker_processes import become_worker
from wildscav_engine.maps import MapError, map_of
from wildscav_engine.record import Record, RecordError, read_record
from wildscav_engine.specs.map_spec import MapSpec
from wildscav_engine.storage.files import write_whole
from wildscav_engine.view import ViewError, rendered
from wildscav_engine.view.video.encode import Pace, check_encoder, write_poster, write_video
from wildscav_engine.view.video.film import Film, Look, VideoError
from wildscav_leaderboard.spectating.render_cache import PROGRESS, QUIET, SPEC
from wildscav_stage.scene.map_file import map_file
from wildscav_stage.scene.notes import notes_beside
from wildscav_stage.scene.trails import trails_of

VIDEO = Look("follow", width=640, height=360, detail=0.75)
POSTER = Look("follow", width=1280, height=720, detail=1.0)
PICTURES = 20.0  # a second
LONGEST = 180.0  # s of a video: longer matches are shown faster, so that none takes long to render
NICENESS = 10  # pages are answered first
TOLD_EVERY = 0.5  # s


def pace_of(seconds: float) -> Pace:
    """Return how fast a match is shown that takes some seconds."""
    return Pace(fps=PICTURES, speed=max(1.0, seconds / LONGEST))


def render_trails(record: Path, target: Path) -> None:
    """Write the document of a match's trails, compressed."""
    write_whole(target, trails_of(read_record(record)).compressed())


def render_map(source: Path, target: Path) -> None:
    """Write the file of a map: of a match's record, or of a file with a MapSpec."""
    if source.suffix == SPEC:
        game_map = map_of(MapSpec.model_validate_json(source.read_bytes()))
    else:
        record = read_record(source)
        game_map = map_of(record.spec.map)
        if game_map.digest != record.map_digest:
            raise RecordError("this engine makes another map of its spec")
    write_whole(target, map_file(game_map))


def render_replay(record: Path, target: Path) -> None:
    """Write the replay of a match for Rerun."""
    played = read_record(record)
    write_whole(target, rendered(played, notes=public_notes(record, played, target)))


def public_notes(record: Path, played: Record, target: Path) -> list[Note]:
    """Return the notes for whoever may watch a match; none if an organizer has hidden them."""
    is_quiet = target.name.partition(".")[0].endswith(QUIET)
    return [] if is_quiet else [note for note in notes_beside(record, played) if note.public]


def render_poster(record: Path, target: Path) -> None:
    """Write the picture of a match that shows most of it as a JPEG."""
    write_poster(Film(read_record(record), POSTER), target)


def render_video(record: Path, target: Path) -> None:
    """Write the video of a match as an MP4, and meanwhile how far it is."""
    told = 0.0

    def report(done: int, count: int) -> None:
        nonlocal told
        if time.monotonic() - told >= TOLD_EVERY:
            told = time.monotonic()
            write_whole(target.with_name(PROGRESS), str(100 * done // count).encode())

    check_encoder(target)
    played = read_record(record)
    film = Film(played, VIDEO, notes=public_notes(record, played, target))
    # Half of the processors: the season's matches are played on them, too.
    threads = max(1, (os.cpu_count() or 1) // 2)
    write_video(film, target, pace_of(film.seconds), threads=threads, report=report)


RENDERERS: dict[str, Callable[[Path, Path], None]] = {
    "trails": render_trails,
    "map": render_map,
    "replay": render_replay,
    "poster": render_poster,
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
    except (OSError, UserError, MapError, RecordError, VideoError, ViewError) as error:
        raise SystemExit(describe(error)) from None


if __name__ == "__main__":
    main()
