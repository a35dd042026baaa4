"""Videos as files: MP4 by PyAV, animated GIF and WebP by Pillow, never half-written."""

import os
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import AbstractContextManager
from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

from PIL import Image

from wildscav_engine.storage.files import part_of
from wildscav_engine.view.video import MP4, PICTURES, VIDEOS
from wildscav_engine.view.video.film import Film, VideoError

CODEC, PIXELS = "libx264", "yuv420p"  # which every browser and every player shows
QUALITY = {"preset": "superfast", "crf": "23"}
COLORS = 128  # of each picture of a GIF
WEBP_QUALITY = 70
WAITING = 3  # pictures a thread, that may be ready before the encoder takes them
LAST = 2.5  # s, for which the end of the match stays


class Pace(NamedTuple):
    """Which part of a match a video shows, and how fast."""

    start: float = 0.0  # s of the match
    end: float | None = None  # s of the match; None: its end
    fps: float = 25.0  # pictures a second
    speed: float = 1.0  # s of the match a second


def times_of(pace: Pace, seconds: float) -> list[float]:
    """Return the times in s of the pictures of a match that takes some seconds.

    Raises:
        VideoError: A number is outside its range, or the match is over before the start.
    """
    end = seconds if pace.end is None else min(pace.end, seconds)
    if not 1.0 <= pace.fps <= 60.0:
        raise VideoError(f"the pictures a second are {pace.fps:g}, must be 1 to 60")
    if not 0.05 <= pace.speed <= 50.0:
        raise VideoError(f"the speed is {pace.speed:g}, must be 0.05 to 50")
    if not 0.0 <= pace.start <= end:
        raise VideoError(f"the video would go from {pace.start:g} s to {end:g} s of a match of {seconds:g} s")
    step = pace.speed / pace.fps
    count = int((end - pace.start) / step + 1e-9) + 1
    times = [pace.start + step * index for index in range(count)]
    if end == seconds:  # the outcome can be read
        times += [seconds] * round(LAST * pace.fps)
    return times


def check_encoder(path: Path) -> None:
    """Refuse a video that cannot be encoded here, before anything is rendered.

    Raises:
        VideoError: PyAV is not installed, which MP4 needs.
    """
    if path.suffix.lower() == MP4 and find_spec("av") is None:
        raise VideoError("MP4 videos need PyAV: pip install 'wildscav[video]'")


def write_video(
    film: Film,
    path: Path,
    pace: Pace | None = None,
    *,
    threads: int | None = None,
    report: Callable[[int, int], None] | None = None,
) -> None:
    """Write a match as a video.

    Args:
        path: The file to write: ``.mp4``, ``.gif`` or ``.webp``.
        pace: Which part of it, and how fast; None for all of it.
        threads: That take pictures at the same time; None for one a processor core.
        report: Called after each picture, with how many are written and how many there are.

    Raises:
        VideoError: The name has another suffix, PyAV is not installed, or a number of the pace is wrong.
        OSError: The file cannot be written. An older file stays as it was.
    """
    chosen = pace or Pace()
    times = times_of(chosen, film.seconds)
    check_encoder(path)
    write = {MP4: _write_mp4, ".gif": _write_gif, ".webp": _write_webp}.get(path.suffix.lower())
    if write is None:
        raise VideoError(f"{path}: the name of a video must end in {', '.join(VIDEOS)}")
    with _part_of(path) as part:
        pictures = _taken(film, times, threads or os.cpu_count() or 1)
        write(part, _reported(pictures, len(times), report), chosen.fps, film)


def write_poster(film: Film, path: Path, seconds: float | None = None) -> None:
    """Write one picture of a match.

    Args:
        path: The file to write: ``.png``, ``.webp`` or ``.jpg``.
        seconds: The time in the match; None for the moment that shows most.

    Raises:
        VideoError: The name has another suffix, or the match is over before that time.
        OSError: The file cannot be written. An older file stays as it was.
    """
    if path.suffix.lower() not in PICTURES:
        raise VideoError(f"{path}: the name of a picture must end in {', '.join(PICTURES)}")
    if seconds is not None and not 0.0 <= seconds <= film.seconds:
        raise VideoError(f"the picture would be of {seconds:g} s of a match of {film.seconds:g} s")
    picture = film.picture(film.best_time if seconds is None else seconds)
    kind = {".jpg": "JPEG", ".jpeg": "JPEG"}.get(path.suffix.lower(), path.suffix[1:].upper())
    with _part_of(path) as part:
        picture.save(part, kind, quality=85)


def _part_of(path: Path) -> AbstractContextManager[Path]:
    """Return the context in which a file is written under another name until it is whole.

    Raises:
        VideoError: The path is that of something else than a file.
    """
    if path.exists() and not path.is_file():
        raise VideoError(f"{path} is not a file")
    return part_of(path)


def _taken(film: Film, times: list[float], threads: int) -> Iterator[Image.Image]:
    """Yield the pictures in their order, while threads take the next ones."""
    waiting: deque[Future[Image.Image]] = deque()
    with ThreadPoolExecutor(threads) as pool:
        try:
            for time in times:
                waiting.append(pool.submit(film.picture, time))
                if len(waiting) >= WAITING * threads:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _reported(
    pictures: Iterator[Image.Image], count: int, report: Callable[[int, int], None] | None
) -> Iterator[Image.Image]:
    for done, picture in enumerate(pictures, start=1):
        yield picture
        if report is not None:
            report(done, count)


def _write_mp4(part: Path, pictures: Iterator[Image.Image], fps: float, film: Film) -> None:
    import av

    with av.open(str(part), "w", format="mp4", options={"movflags": "+faststart"}) as container:
        new_frame: Any = av.VideoFrame.from_image
        stream: Any = container.add_stream(CODEC, rate=Fraction(fps).limit_denominator(1000))
        stream.width, stream.height = (length - length % 2 for length in (film.look.width, film.look.height))
        stream.pix_fmt, stream.options = PIXELS, QUALITY
        for picture in pictures:
            container.mux(stream.encode(new_frame(picture)))
        container.mux(stream.encode())


def _write_gif(part: Path, pictures: Iterator[Image.Image], fps: float, film: Film) -> None:  # noqa: ARG001
    few = (
        picture.quantize(COLORS, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE) for picture in pictures
    )
    _save(part, few, fps, format="GIF", optimize=False)


def _write_webp(part: Path, pictures: Iterator[Image.Image], fps: float, film: Film) -> None:  # noqa: ARG001
    _save(part, pictures, fps, format="WEBP", quality=WEBP_QUALITY, method=3)


def _save(part: Path, pictures: Iterator[Image.Image], fps: float, **options: Any) -> None:
    first = next(pictures)
    first.save(part, save_all=True, append_images=pictures, duration=round(1000 / fps), loop=0, **options)
