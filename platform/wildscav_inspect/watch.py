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
LATEST = "latest"  # in place of a path
DEPTH = 4  # folders below this one, down to which the latest record is looked for
SCENE = ("map.gz", "match.json.gz", "notes.json.gz")  # files from which a viewer draws a match


def watch(
    record: Annotated[
        Path,
        typer.Argument(
            help="Record file, the number or the page of a match of a season, a folder with records, such as "
            "the output of an evaluation, or latest.",
            metavar="RECORD",
            show_default=False,
        ),
    ],
    other: Annotated[
        Path | None,
        typer.Option(
            "--with", help="Another match, to be shown beside it.", metavar="RECORD", show_default=False
        ),
    ] = None,
    season: SeasonOption = None,
    logs: LogsOption = None,
    host: Annotated[str, typer.Option(help="Address that the page is served on.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="Its port; 0 for any free one.", min=0, max=65535)] = 0,
    browser: Annotated[bool, typer.Option(help="Open the page in a browser.")] = True,
) -> None:
    """Watch recorded matches in 3D, in the browser; Ctrl-C ends it."""
    from wildscav.system.ports import check_port
    from wildscav.terminal.console import console, error_console
    from wildscav_engine.view.web import link_to
    from wildscav_stage.listening import listen
    from wildscav_stage.viewer_files import viewer_addresses
    from wildscav_stage.watching.match_site import match_site, serve

    check_port(host, port)  # before the records are read
    path = _latest() if str(record) == LATEST and not record.exists() else resolve_record(record, season)
    records = _records_in(path) if path.is_dir() else [path]
    if logs is not None and (len(records) > 1 or other is not None):
        raise UserError("--logs is for one match: name its record, and leave out --with", exit_code=2)
    if other is not None:
        records = [_one_record(records, path), _one_record([resolve_record(other, season)], other)]
    viewer_addresses()  # before the link is printed
    with error_console.status(f"playing {escape(path.name)}"):
        site = match_site(f"Matches of {path.resolve().name}", records, host, logs)
    listening = listen(host, port)
    link = link_to(host, listening.getsockname()[1])
    if other is not None:
        link = f"{link}matches/0?with=1"
    console.print(f"watch at {link}", "Ctrl-C ends it.", sep="\n")
    if browser:
        webbrowser.open(link)
    serve(site, listening)


def _one_record(records: list[Path], path: Path) -> Path:
    """Return the record that is meant where two are compared."""
    from wildscav_stage.watching.match_page import title_of

    if len(records) > 1 or records[0].is_dir():
        raise UserError(f"{path} is a folder: name one of its records", exit_code=2)
    title_of(records[0])  # which it has if it can be read
    return records[0]


def _latest() -> Path:
    """Return the newest record below this folder; of an evaluation's, the folder of that evaluation."""
    from wildscav_engine.record import SUFFIX

    found = [path for depth in range(DEPTH + 1) for path in Path().glob(f"{'*/' * depth}*{SUFFIX}")]
    if not found:
        raise UserError(f"there are no records ({SUFFIX}) in this folder, nor in those below it")
    newest = max(found, key=lambda path: path.stat().st_mtime)
    return newest.parent.parent if newest.parent.name == RECORDS else newest


def _records_in(folder: Path) -> list[Path]:
    """Return the records in a folder, or in that of an evaluation's records."""
    from wildscav_engine.record import SUFFIX

    found = sorted([*folder.glob(f"*{SUFFIX}"), *(folder / RECORDS).glob(f"*{SUFFIX}")])
    if not found:
        raise UserError(f"{folder}: there are no records ({SUFFIX}) in it, nor in its folder {RECORDS}")
    return found


def write_scene(record: Path, folder: Path, logs: Path | None) -> None:
    """Write the files from which a viewer draws a match; a UserError if one cannot be read or written."""
    from wildscav.terminal.console import console, error_console
    from wildscav_engine.storage.files import write_whole
    from wildscav_stage.watching.match_page import scene_of

    with error_console.status(f"playing {escape(record.name)}"):
        scene = scene_of(record, logs)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"cannot make {folder}: {error.strerror}") from None
    for name, content in zip(SCENE, scene[1:], strict=True):
        write_whole(folder / name, content)
        console.print(f"{folder / name}: {len(content) / 1e3:.0f} kB")


def write_page(record: Path, out: Path | None, logs: Path | None) -> None:
    """Write a page that plays a match without a server, by default under the record's name with ``.html``.

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
