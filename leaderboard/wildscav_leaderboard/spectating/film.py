"""The video of a recorded match and its poster, from behind whoever has most to do."""

import os
from collections.abc import Callable
from pathlib import Path

from wildscav.errors import UserError
from wildscav_engine.record import RecordError, read_record
from wildscav_engine.view.video.encode import Pace, check_encoder, write_poster, write_video
from wildscav_engine.view.video.film import Film, Look, VideoError

VIDEO = Look("follow", width=640, height=360, detail=0.75)
POSTER = Look("follow", width=1280, height=720, detail=1.0)
PICTURES = 20.0  # a second
LONGEST = 180.0  # s of a video: longer matches are shown faster, so that none takes long to render


def pace_of(seconds: float) -> Pace:
    """Return how fast a match is shown that takes some seconds."""
    return Pace(fps=PICTURES, speed=max(1.0, seconds / LONGEST))


def write_match_video(record: Path, target: Path, report: Callable[[int, int], None]) -> None:
    """Write the video of a match as an MP4.

    Args:
        record: The record.
        target: The file.
        report: Called after each picture, with how many are written and how many there are.

    Raises:
        UserError: PyAV is missing, or the record cannot be read or be played again.
    """
    try:
        check_encoder(target)
        film = Film(read_record(record), VIDEO)
        # Half of the processors: the season's matches are played on them, too.
        threads = max(1, (os.cpu_count() or 1) // 2)
        write_video(film, target, pace_of(film.seconds), threads=threads, report=report)
    except (VideoError, RecordError) as error:
        raise UserError(str(error)) from None


def write_match_poster(record: Path, target: Path) -> None:
    """Write the picture of a match that shows most of it as a JPEG.

    Raises:
        UserError: The record cannot be read or be played again.
    """
    try:
        write_poster(Film(read_record(record), POSTER), target)
    except (VideoError, RecordError) as error:
        raise UserError(str(error)) from None
