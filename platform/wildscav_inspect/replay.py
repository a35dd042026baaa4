"""``wildscav replay``: render a record for Rerun, as a video or as a page, or serve it in Rerun's viewer."""

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

from wildscav.cli.shared_options import takes
from wildscav.errors import UserError
from wildscav_inspect.records import LogsOption, SeasonOption, read_of_seat, resolve_record
from wildscav_inspect.video import VIDEO, VideoOptions, make_video
from wildscav_inspect.watch import HTML, write_page, write_scene

if TYPE_CHECKING:
    from wildscav_engine.record import Record

RERUN_MAGIC = b"RRF"  # the first bytes of every .rrd file
SUFFIX = ".rrd"


RecordArgument = Annotated[
    Path,
    typer.Argument(
        help="Record file, or the number or the page of a match of a season; with --web also a replay "
        "(.rrd).",
        metavar="RECORD",
        show_default=False,
    ),
]
Out = Annotated[
    Path | None,
    typer.Option(
        "--out",
        "-o",
        help="File to write: .rrd, a page (.html), or a video (.mp4, .gif, .webp). Default: the record's "
        "name with .rrd, with .html for --html, or with .mp4 for --video; with --web, none.",
    ),
]
Seat = Annotated[
    int | None,
    typer.Option(
        help="Seat that the cameras follow. Default: the first submission; of a video from behind, "
        "whoever has most to do.",
        min=0,
    ),
]
Images = Annotated[
    bool, typer.Option(help="Draw the images of the followed agent's camera and depth camera.")
]
Html = Annotated[
    bool, typer.Option("--html", help="Make a page that plays it in 3D in any browser, without a server.")
]
Scene = Annotated[
    Path | None,
    typer.Option(
        "--scene", help="Write the two files from which a viewer of one's own draws it to this folder."
    ),
]
Web = Annotated[
    bool,
    typer.Option(
        "--web",
        help="Serve it with a browser viewer until Ctrl-C; ?theme=light or ?theme=dark chooses a theme.",
    ),
]
Host = Annotated[
    str | None, typer.Option(help="Address that --web listens on. Default: 127.0.0.1, this machine only.")
]
Port = Annotated[
    int | None, typer.Option(help="Port that --web listens on. Default: any free one.", min=0, max=65535)
]
Video = Annotated[
    bool,
    typer.Option("--video", help="Make a video, as --out does that names one.", rich_help_panel=VIDEO),
]


@takes(VideoOptions)
def replay(
    wanted: VideoOptions,
    record: RecordArgument,
    out: Out = None,
    seat: Seat = None,
    images: Images = True,
    html: Html = False,
    scene: Scene = None,
    web: Web = False,
    host: Host = None,
    port: Port = None,
    video: Video = False,
    season: SeasonOption = None,
    logs: LogsOption = None,
) -> None:
    """Render a record: for Rerun, as a page that plays it in 3D, as a video, or as one picture."""
    from wildscav_engine.view.video import VIDEOS

    suffix = "" if out is None else out.suffix.lower()
    has_others = (
        web or video or not images or any(each is not None for each in (seat, host, port, wanted.given()))
    )
    if scene is not None:
        if has_others or html or out is not None:
            raise UserError("--scene takes --season and --logs, and no other options", exit_code=2)
        return write_scene(resolve_record(record, season), scene, logs)
    if html or suffix == HTML:
        if has_others:
            raise UserError("--html takes --out, --season and --logs, and no other options", exit_code=2)
        return write_page(resolve_record(record, season), out, logs)
    if video or wanted.poster is not None or suffix in VIDEOS:
        if web:
            raise UserError("--web is for replays: leave it out, or --video and --poster", exit_code=2)
        return make_video(record, seat, out, wanted, season, logs)
    if given := wanted.given():
        raise UserError(f"{given} is for a video or a picture: add --video or --poster", exit_code=2)
    if not web and (host is not None or port is not None):
        raise UserError("--host and --port are for --web: add --web", exit_code=2)
    return _replay_for_rerun(resolve_record(record, season), out, seat, images, logs, web, host, port)


def _replay_for_rerun(
    record: Path,
    out: Path | None,
    seat: int | None,
    images: bool,
    logs: Path | None,
    web: bool,
    host: str | None,
    port: int | None,
) -> None:
    """Write a record as a Rerun recording, serve it, or both; a recording is served as it is."""
    if web and _is_replay(record):
        _refuse_rendering_options(out, seat, images, logs)
        _serve(record.read_bytes(), record.name, host, port)
        return
    content = _render(record, read_of_seat(record, "--seat", seat), out, seat, images, logs, web=web)
    path = out if web else out or record.with_suffix(SUFFIX)
    if path is not None:
        _write(path, content)
    if web:
        _serve(content, record.name, host, port)


def _is_replay(path: Path) -> bool:
    try:
        with path.open("rb") as file:
            return file.read(len(RERUN_MAGIC)) == RERUN_MAGIC
    except OSError:
        return False  # reading it as a record reports the error


def _refuse_rendering_options(out: Path | None, seat: int | None, images: bool, logs: Path | None) -> None:
    """Refuse options of rendering for a replay that is already rendered."""
    given = {"--out": out, "--seat": seat, "--logs": logs}
    options = {name: value is not None for name, value in given.items()} | {"--no-images": not images}
    for option, is_given in options.items():
        if is_given:
            raise UserError(f"{option} needs a record: this is a replay already", exit_code=2)


def _render(
    record: Path,
    played: "Record",
    out: Path | None,
    seat: int | None,
    images: bool,
    logs: Path | None,
    *,
    web: bool,
) -> bytes:
    """Check that the output would not overwrite the record, and render it."""
    from wildscav.terminal.console import error_console
    from wildscav_engine.record import RecordError
    from wildscav_engine.view import ViewError, rendered
    from wildscav_stage.scene.notes import notes_beside

    path = out or record.with_suffix(SUFFIX)
    if (out is not None or not web) and path.exists() and path.samefile(record):
        raise UserError(
            f"{path} is the record itself, which the replay would overwrite: name another --out",
            exit_code=2,
        )
    check_name("--out", path)
    with error_console.status(f"rendering {escape(path.name)}"):
        try:
            return rendered(played, follow=seat, images=images, notes=notes_beside(record, played, logs))
        except RecordError as error:
            raise UserError(f"{record}: {error}") from None
        except ViewError as error:
            raise UserError(str(error)) from None


def _write(path: Path, content: bytes) -> None:
    """Write the file, and print how to open it."""
    from wildscav.terminal.console import command, console
    from wildscav_engine.storage.files import write_whole

    write_whole(path, content)
    lines = (
        f"{path}: {len(content) / 1e6:.1f} MB. Open it with:",
        f"  {command('rerun')} {shlex.quote(str(path))}",
    )
    console.print(*lines, sep="\n")


def _serve(content: bytes, name: str, host: str | None, port: int | None) -> None:
    """Serve a replay until Ctrl-C."""
    from wildscav.terminal.console import console, error_console
    from wildscav_engine.view import ViewError
    from wildscav_engine.view.web import LOOPBACK, ReplayServer

    with error_console.status("unpacking the viewer"):
        try:
            server = ReplayServer(content, host or LOOPBACK, port or 0)
        except ViewError as error:
            raise UserError(str(error)) from None
    with server:
        lines = (f"{name} is at {server.link}", "Ctrl-C ends it.")
        console.print(*lines, sep="\n")
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            console.print("Ended.")


def check_name(option: str, path: Path) -> None:
    """Raise a UserError for a file name without ".rrd", the suffix of Rerun recordings that viewers go by."""
    if path.suffix.lower() != SUFFIX:
        raise UserError(
            f"{option} is {path}: a replay is a Rerun recording, so its name must end in {SUFFIX}", 2
        )
