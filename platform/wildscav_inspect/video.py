"""What ``wildscav replay`` does for videos: a recorded match as a video or as one picture."""

from collections.abc import Callable
from contextlib import contextmanager
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

import typer

from wildscav.errors import UserError
from wildscav_inspect.records import read_of_seat, resolve_record

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from wildscav.notes import Note
    from wildscav_engine.record import Record
    from wildscav_engine.view.video.encode import Pace
    from wildscav_engine.view.video.film import Film, Look, View

VIEWS: dict[str, "View"] = {"eyes": "eyes", "behind": "follow", "above": "overview", "grid": "grid"}
OF_MP4 = (1280, 720, 25.0)  # pixels across and down, pictures a second
OF_ANIMATION = (640, 360, 10.0)  # the same of a GIF or WebP, which would be large
VIDEO = "Videos and pictures"  # the panel of the help


class VideoOptions(NamedTuple):
    """The options of ``wildscav replay`` for videos and pictures."""

    poster: Annotated[
        Path | None,
        typer.Option(
            help="Write one picture (.png, .webp or .jpg) instead: at --start, or where most happens.",
            metavar="FILE",
            rich_help_panel=VIDEO,
        ),
    ] = None
    view: Annotated[
        Literal["eyes", "behind", "above", "grid"] | None,
        typer.Option(
            help="Watch through the eyes of an agent, from behind it, from above, or through the eyes of all "
            "seats (at most 16) side by side. Default: eyes.",
            rich_help_panel=VIDEO,
        ),
    ] = None
    start: Annotated[
        float | None,
        typer.Option(help="Where in the match to begin, in seconds.", min=0, rich_help_panel=VIDEO),
    ] = None
    end: Annotated[
        float | None,
        typer.Option(help="Where in the match to end, in seconds.", min=0, rich_help_panel=VIDEO),
    ] = None
    speed: Annotated[
        float | None,
        typer.Option(
            help="Seconds of the match in a second of the video. Default: 1.", rich_help_panel=VIDEO
        ),
    ] = None
    size: Annotated[
        str | None,
        typer.Option(
            help="Size in pixels. Default: 1280x720; of .gif and .webp 640x360.",
            metavar="WxH",
            rich_help_panel=VIDEO,
        ),
    ] = None
    fps: Annotated[
        float | None,
        typer.Option(help="Pictures a second. Default: 25; of .gif and .webp 10.", rich_help_panel=VIDEO),
    ] = None
    detail: Annotated[
        float | None,
        typer.Option(
            help="Share of width and height that is rendered, 0.2 to 1. Default: 0.5; of one picture 1, "
            "which is sharper and takes three times as long.",
            rich_help_panel=VIDEO,
        ),
    ] = None

    def given(self) -> str | None:
        """Return the first option that was given; None if none was."""
        return next((f"--{name}" for name, value in self._asdict().items() if value is not None), None)


def make_video(
    record: Path,
    seat: int | None,
    out: Path | None,
    options: VideoOptions,
    season: str | None,
    logs: Path | None,
) -> None:
    """Render a record as a video or as one picture.

    Args:
        record: Its file, or the number of a match of a season.
        seat: The seat to watch; None for the first submission, and from behind, for whoever has most to do.
        logs: Where its agents' notes are; see ``notes_beside``.

    Raises:
        UserError: The options do not go together, or the record cannot be rendered.
    """
    from wildscav_engine.view.video import MP4

    poster, speed = options.poster, 1.0 if options.speed is None else options.speed
    view = VIEWS[options.view or "eyes"]
    if seat is not None and options.view in {"above", "grid"}:
        raise UserError(f"--seat and --view {options.view} exclude each other", exit_code=2)
    if poster is not None and (out is not None or (options.end, options.fps, options.speed) != (None,) * 3):
        raise UserError("--poster is one picture: leave out --out, --end, --fps and --speed", exit_code=2)
    path = poster or out or record.with_suffix(MP4)
    _check_name(path, is_poster=poster is not None)
    record = resolve_record(record, season)
    played = read_of_seat(record, "--seat", seat)
    from wildscav_engine.record import RecordError
    from wildscav_engine.view.video.encode import Pace, check_encoder, write_poster
    from wildscav_engine.view.video.film import DETAIL, Look, VideoError
    from wildscav_stage.scene.notes import notes_beside

    width, height, pictures = OF_MP4 if poster or path.suffix.lower() == MP4 else OF_ANIMATION
    width, height = _size(options.size) if options.size else (width, height)
    detail = (1.0 if poster else DETAIL) if options.detail is None else options.detail
    look = Look(view, seat, width, height, detail)
    try:
        check_encoder(path)
        film = _film(played, look, path, notes_beside(record, played, logs))
        if poster:
            write_poster(film, path, options.start)
            _say(path, "one picture")
        else:
            fps = pictures if options.fps is None else options.fps
            _write(film, path, Pace(options.start or 0.0, options.end, fps, speed))
    except VideoError as error:
        raise UserError(str(error)) from None
    except RecordError as error:
        raise UserError(f"{record}: {error}") from None


def _film(played: "Record", look: "Look", path: Path, notes: "Sequence[Note]") -> "Film":
    """Play a record again, for a file that it will be written to."""
    from wildscav_engine.view.video.film import Film

    with _bar(f"playing {path.stem}", "steps") as report:
        return Film(played, look, lambda step: report(step, played.steps), notes)


def _write(film: "Film", path: Path, pace: "Pace") -> None:
    """Render a video, and say how long that took."""
    from wildscav_engine.view.video.encode import write_video

    began = monotonic()
    with _bar(f"rendering {path.name}", "pictures") as report:
        write_video(film, path, pace, report=report)
    shown = (film.seconds if pace.end is None else min(pace.end, film.seconds)) - pace.start
    _say(path, f"{shown:.0f} s of the match in {monotonic() - began:.0f} s")


def _check_name(path: Path, *, is_poster: bool) -> None:
    """Refuse a name that says no format which can be written."""
    from wildscav_engine.view.video import PICTURES, VIDEOS

    allowed, option = (PICTURES, "--poster") if is_poster else (VIDEOS, "--out")
    if path.suffix.lower() not in allowed:
        raise UserError(f"{option} is {path}: its name must end in {', '.join(allowed)}", exit_code=2)


def _size(text: str) -> tuple[int, int]:
    """Return the width and the height in a text such as 1280x720."""
    width, _, height = text.lower().partition("x")
    if not (width.isdecimal() and height.isdecimal() and len(text) < 12):
        raise UserError(f"--size is {text!r}, must be a width and a height such as 1280x720", exit_code=2)
    return int(width), int(height)


@contextmanager
def _bar(title: str, unit: str) -> "Iterator[Callable[[int, int], None]]":
    """Show a progress bar while something is done, and yield what it is told with."""
    from wildscav.terminal.console import counting, error_console
    from wildscav_engine.compilation.engine_progress import preparing

    with preparing(error_console), counting(title, unit) as report:
        yield report


def _say(path: Path, what: str) -> None:
    from wildscav.terminal.console import console

    console.print(f"{path}: {path.stat().st_size / 1e6:.1f} MB, {what}")
