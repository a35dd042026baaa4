"""``wildscav watch``: recorded matches in 3D in a browser, and a file with one that plays anywhere."""

import webbrowser
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from wildscav.errors import UserError
from wildscav_inspect.records import LogsOption, SeasonOption, resolve_record

HTML = ".html"
RECORDS = "records"  # folder in the output of an evaluation


def watch(
    record: Annotated[
        Path,
        typer.Argument(
            help="Record file, the number or the page of a match of a season, or a folder with records, "
            "such as the output of an evaluation.",
            metavar="RECORD",
            show_default=False,
        ),
    ],
    season: SeasonOption = None,
    logs: LogsOption = None,
    host: Annotated[str, typer.Option(help="Address that the page is served on.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="Its port; 0 for any free one.", min=0, max=65535)] = 0,
    browser: Annotated[bool, typer.Option(help="Open the page in a browser.")] = True,
) -> None:
    """Watch recorded matches in 3D, in the browser; Ctrl-C ends it."""
    from wildscav.terminal.console import console, error_console
    from wildscav_engine.view.web import link_to
    from wildscav_stage.listening import listen
    from wildscav_stage.viewer_files import viewer_addresses
    from wildscav_stage.watching.match_site import match_site, serve

    path = resolve_record(record, season)
    records = _records_in(path) if path.is_dir() else [path]
    if logs is not None and len(records) > 1:
        raise UserError("--logs is for one match: name its record", exit_code=2)
    viewer_addresses()  # before the link is printed
    with error_console.status(f"playing {escape(path.name)}"):
        site = match_site(f"Matches of {path.resolve().name}", records, host, logs)
    listening = listen(host, port)
    link = link_to(host, listening.getsockname()[1])
    console.print(f"watch at {link}", "Ctrl-C ends it.", sep="\n")
    if browser:
        webbrowser.open(link)
    serve(site, listening)


def _records_in(folder: Path) -> list[Path]:
    """Return the records in a folder, or in that of an evaluation's records.

    Raises:
        UserError: There is none.
    """
    from wildscav_engine.record import SUFFIX

    found = sorted([*folder.glob(f"*{SUFFIX}"), *(folder / RECORDS).glob(f"*{SUFFIX}")])
    if not found:
        raise UserError(f"{folder}: there are no records ({SUFFIX}) in it, nor in its folder {RECORDS}")
    return found


def write_page(record: Path, out: Path | None, logs: Path | None) -> None:
    """Write a page with a match that plays without a server.

    Args:
        record: The file of its record.
        out: The page; None for the record's name with ``.html``.
        logs: Where its agents' notes are; see ``notes_beside``.

    Raises:
        UserError: The record cannot be read, or the page not be written there.
    """
    from wildscav.terminal.console import console, error_console
    from wildscav_engine.storage.files import write_whole
    from wildscav_stage.watching.match_page import scene_of, whole_page

    if record.is_dir():
        raise UserError(f"{record} is a folder: name one of its records", exit_code=2)
    path = out or record.with_suffix(HTML)
    if path.suffix.lower() != HTML:
        raise UserError(f"--out is {path}: the name of a page must end in {HTML}", exit_code=2)
    if path.exists() and record.exists() and path.samefile(record):
        raise UserError(f"{path} is the record itself: name another --out", exit_code=2)
    with error_console.status(f"playing {escape(record.name)}"):
        content = whole_page(scene_of(record, logs)).encode()
    write_whole(path, content)
    console.print(f"{path}: {len(content) / 1e6:.1f} MB. Open it with any browser.")
