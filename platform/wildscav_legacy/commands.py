"""``wildscav-legacy``: the client of the original game on this engine."""

from pathlib import Path
from typing import Annotated

import typer

from wildscav.errors import UserError

DEFAULT_MAPS = "1-20,91-130"
LAST_MAP = 999

app = typer.Typer(
    name="wildscav-legacy",
    help="Let the client of the original game, inspirai_fps, play on this engine.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)


def main() -> None:
    """Run the program."""
    from wildscav.cli.main import run

    run(app, "wildscav-legacy")


@app.callback()
def legacy() -> None:
    """Let the client of the original game, inspirai_fps, play on this engine."""


@app.command()
def install(
    folder: Annotated[Path, typer.Argument(help="Folder to write into.", metavar="DIR", show_default=False)],
    maps: Annotated[
        str, typer.Option(help="Ids of maps, such as 1,2,101-130; maps that are there already are kept.")
    ] = DEFAULT_MAPS,
) -> None:
    """Write what the client needs: DIR/engine with an executable fps.x86_64, and DIR/maps.

    Scripts for the original then run unchanged: Game(map_dir="DIR/maps", engine_dir="DIR/engine").
    """
    from wildscav.terminal.console import console, counted, error_console, progress_bar
    from wildscav_engine.compilation.engine_progress import preparing
    from wildscav_engine.parallel.threads import cores
    from wildscav_legacy.install import install_engine, install_maps, missing_maps
    from wildscav_server.hosting.precompile import precompile

    ids = read_ids(maps)
    program = install_engine(folder / "engine")
    with preparing(error_console):
        precompile(())
    missing = missing_maps(ids, folder / "maps")
    with progress_bar() as progress:
        task = progress.add_task("making maps", total=len(missing))
        for _ in install_maps(missing, folder / "maps", cores()):
            progress.advance(task)
    present = len(ids) - len(missing)
    lines = [
        str(program),
        f"{folder / 'maps'}: {counted(len(missing), 'map')} made, {present} there already",
        f'Game(map_dir="{(folder / "maps").absolute()}", engine_dir="{program.parent.absolute()}")',
    ]
    console.print(*lines, sep="\n")


def read_ids(text: str) -> list[int]:
    """Return the ids in a list such as ``1,2,101-130``, ascending and without duplicates.

    Raises:
        UserError: The text is not such a list, or no map has one of the ids.
    """
    ids: set[int] = set()
    for part in text.split(","):
        first, dash, last = (word.strip() for word in part.partition("-"))
        if not first.isdecimal() or not (last.isdecimal() if dash else not last):
            raise UserError(f"--maps has {part.strip()!r}, must be ids and ranges such as 1,2,101-130", 2)
        low, high = int(first), int(last or first)
        if not 1 <= low <= high <= LAST_MAP:
            raise UserError(f"--maps has {part.strip()!r}, must be within 1 to {LAST_MAP} and ascending", 2)
        ids.update(range(low, high + 1))
    return sorted(ids)
