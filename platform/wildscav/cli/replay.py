"""``wildscav replay``: render a record as a Rerun recording."""

import shlex
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from wildscav.errors import UserError


def replay(
    record: Annotated[Path, typer.Argument(help="Record file.", metavar="RECORD", show_default=False)],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="File to write. Default: the record's name with .rrd."),
    ] = None,
    follow: Annotated[
        int | None, typer.Option(help="Seat that the cameras follow. Default: the first submission.", min=0)
    ] = None,
    images: Annotated[
        bool, typer.Option(help="Draw what the followed agent's camera and depth camera see.")
    ] = True,
) -> None:
    """Render a record as a replay that can be watched in 3D."""
    from wildscav.console import command, console, error_console
    from wildscav_engine.record import RecordError, read_record
    from wildscav_engine.view import ViewError, write_replay

    try:
        played = read_record(record)
    except RecordError as error:
        raise UserError(str(error)) from None
    if follow is not None and follow >= len(played.names):
        raise UserError(
            f"--follow is {follow}; the match has seats 0 to {len(played.names) - 1}", exit_code=2
        )
    path = output or record.with_suffix(".rrd")
    if path.exists() and path.samefile(record):
        raise UserError(
            f"{path} is the record itself, which the replay would overwrite: name another --output",
            exit_code=2,
        )
    with error_console.status(f"rendering {escape(path.name)}"):
        try:
            write_replay(played, path, follow=follow, images=images)
        except RecordError as error:
            raise UserError(f"{record}: {error}") from None
        except ViewError as error:
            raise UserError(str(error)) from None
    lines = (
        f"{path}: {path.stat().st_size / 1e6:.1f} MB. Open it with:",
        f"  {command('rerun')} {shlex.quote(str(path))}",
    )
    console.print(*lines, sep="\n", markup=False, highlight=False, soft_wrap=True)
