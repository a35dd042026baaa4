"""``wildscav video``: a recorded match as a video or as one picture."""

from collections.abc import Callable
from contextlib import contextmanager
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated

import typer

from wildscav.errors import UserError
from wildscav_inspect.records import SeasonOption, read_of_seat, resolve_record

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wildscav_engine.record import Record
    from wildscav_engine.view.video.encode import Pace
    from wildscav_engine.view.video.film import Film, Look, View

SUFFIX = ".mp4"
MP4 = (1280, 720, 25.0)  # pixels across and down, pictures a second
ANIMATION = (640, 360, 10.0)  # the same of a GIF or WebP, which would be large


def video(
    record: Annotated[
        Path,
        typer.Argument(
            help="Record file, or the number of a match of a season.", metavar="RECORD", show_default=False
        ),
    ],
    seat: Annotated[
        int | None,
        typer.Option(
            help="Seat to watch. Default: the first submission; with --follow, whoever has most to do.", min=0
        ),
    ] = None,
    follow: Annotated[
        bool, typer.Option("--follow", help="Watch from behind an agent instead of through its eyes.")
    ] = False,
    overview: Annotated[bool, typer.Option("--overview", help="Watch everybody from above.")] = False,
    grid: Annotated[
        bool, typer.Option("--grid", help="Watch through the eyes of all seats (at most 16) side by side.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", help="File to write: .mp4, .gif or .webp. Default: the record's name with .mp4."
        ),
    ] = None,
    poster: Annotated[
        Path | None,
        typer.Option(
            help="Write one picture (.png, .webp or .jpg) instead: at --start, or where most happens.",
            metavar="FILE",
        ),
    ] = None,
    start: Annotated[
        float | None, typer.Option(help="Where in the match to begin, in seconds.", min=0)
    ] = None,
    end: Annotated[float | None, typer.Option(help="Where in the match to end, in seconds.", min=0)] = None,
    speed: Annotated[float, typer.Option(help="Seconds of the match in a second of the video.")] = 1.0,
    size: Annotated[
        str | None,
        typer.Option(help="Size in pixels. Default: 1280x720; of .gif and .webp 640x360.", metavar="WxH"),
    ] = None,
    fps: Annotated[
        float | None, typer.Option(help="Pictures a second. Default: 25; of .gif and .webp 10.")
    ] = None,
    detail: Annotated[
        float | None,
        typer.Option(
            help="Share of width and height that is rendered, 0.2 to 1. Default: 0.5, of one picture 1."
        ),
    ] = None,
    season: SeasonOption = None,
) -> None:
    """Render a record as a video."""
    view = _view(follow, overview, grid)
    if seat is not None and view in {"overview", "grid"}:
        raise UserError(f"--seat and --{view} exclude each other", exit_code=2)
    if poster is not None and (out is not None or end is not None or fps is not None or speed != 1.0):
        raise UserError("--poster is one picture: leave out --out, --end, --fps and --speed", exit_code=2)
    path = poster or out or record.with_suffix(SUFFIX)
    _check_name(path, is_poster=poster is not None)
    record = resolve_record(record, season)
    played = read_of_seat(record, "--seat", seat)
    from wildscav_engine.record import RecordError
    from wildscav_engine.view.video.encode import Pace, check_encoder, write_poster
    from wildscav_engine.view.video.film import DETAIL, Look, VideoError

    width, height, pictures = MP4 if poster or path.suffix.lower() == SUFFIX else ANIMATION
    width, height = _size(size) if size else (width, height)
    look = Look(view, seat, width, height, detail or (1.0 if poster else DETAIL))
    try:
        check_encoder(path)
        film = _film(played, look, path)
        if poster:
            write_poster(film, path, start)
            _say(path, "one picture")
        else:
            _write(film, path, Pace(start or 0.0, end, fps or pictures, speed))
    except VideoError as error:
        raise UserError(str(error)) from None
    except RecordError as error:
        raise UserError(f"{record}: {error}") from None


def _film(played: "Record", look: "Look", path: Path) -> "Film":
    """Play a record again, for a file that it will be written to."""
    from wildscav_engine.view.video.film import Film

    with _bar(f"playing {path.stem}", "steps") as report:
        return Film(played, look, lambda step: report(step, played.steps))


def _write(film: "Film", path: Path, pace: "Pace") -> None:
    """Render a video, and say how long that took."""
    from wildscav_engine.view.video.encode import write_video

    began = monotonic()
    with _bar(f"rendering {path.name}", "pictures") as report:
        write_video(film, path, pace, report=report)
    shown = (film.seconds if pace.end is None else min(pace.end, film.seconds)) - pace.start
    _say(path, f"{shown:.0f} s of the match in {monotonic() - began:.0f} s")


def _view(follow: bool, overview: bool, grid: bool) -> "View":
    """Return what the video shows.

    Raises:
        UserError: More than one view is asked for.
    """
    chosen: dict[View, bool] = {"follow": follow, "overview": overview, "grid": grid}
    views = [view for view, is_chosen in chosen.items() if is_chosen]
    if len(views) > 1:
        raise UserError(f"--{views[0]} and --{views[1]} exclude each other", exit_code=2)
    return views[0] if views else "eyes"


def _check_name(path: Path, *, is_poster: bool) -> None:
    """Refuse a name that says no format which can be written.

    Raises:
        UserError: It does not.
    """
    from wildscav_engine.view.video.encode import PICTURES, SUFFIXES

    allowed, option = (PICTURES, "--poster") if is_poster else (SUFFIXES, "--out")
    if path.suffix.lower() not in allowed:
        raise UserError(f"{option} is {path}: its name must end in {', '.join(allowed)}", exit_code=2)


def _size(text: str) -> tuple[int, int]:
    """Return the width and the height in a text such as 1280x720.

    Raises:
        UserError: It is no such text.
    """
    width, _, height = text.lower().partition("x")
    if not (width.isdecimal() and height.isdecimal() and len(text) < 12):
        raise UserError(f"--size is {text!r}, must be a width and a height such as 1280x720", exit_code=2)
    return int(width), int(height)


@contextmanager
def _bar(title: str, unit: str) -> "Iterator[Callable[[int, int], None]]":
    """Show a progress bar while something is done, and yield what it is told with."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    from wildscav.terminal.console import error_console
    from wildscav_engine.compilation.engine_progress import preparing

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn(unit),
        TimeRemainingColumn(),
    )
    with preparing(error_console), Progress(*columns, console=error_console, transient=True) as progress:
        task = progress.add_task(title, total=None)
        yield lambda done, total: progress.update(task, completed=done, total=total)


def _say(path: Path, what: str) -> None:
    from wildscav.terminal.console import console

    console.print(f"{path}: {path.stat().st_size / 1e6:.1f} MB, {what}", soft_wrap=True)
