"""``wildscav map``: draw, describe, export and import maps."""

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wildscav.cli.json_option import AsJson
from wildscav.cli.maps.map_import import import_map
from wildscav.cli.maps.map_options import MapCommand, MapOptions
from wildscav.cli.maps.picture_files import format_of, save
from wildscav.cli.shared_options import takes
from wildscav.errors import UserError
from wildscav.system.output_folders import check_folder

if TYPE_CHECKING:
    from rich.table import Table

    from wildscav_engine.maps import GameMap

app = typer.Typer(
    name="map",
    help="Draw, describe, export and import maps.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)
app.command("import")(import_map)


@app.command(cls=MapCommand)
@takes(MapOptions)
def show(
    named: MapOptions,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="File to write. Default: map-NAME.png.")
    ] = None,
    width: Annotated[int, typer.Option(help="Pixels.")] = 1200,
    storey: Annotated[
        int | None, typer.Option(help="Cut the houses open at this storey; 1 is the ground floor.")
    ] = None,
    locations: Annotated[bool, typer.Option("--locations", help="Mark the valid locations.")] = False,
    center: Annotated[
        tuple[float, float] | None, typer.Option(help="x and z of the picture's centre, in metres.")
    ] = None,
    span: Annotated[
        float | None, typer.Option(help="Extent of the picture from west to east, in metres.")
    ] = None,
) -> None:
    """Draw a map from above: relief, water, vegetation, and houses by their storeys or cut open."""
    from wildscav.terminal.console import console, error_console
    from wildscav_engine.maps import MapError
    from wildscav_engine.maps.picture import draw_map

    choice = named.choose()
    path = output or Path(f"{choice.slug}{_suffix(storey, locations, center, span)}.png")
    format_of(path)
    try:
        with error_console.status("drawing"):
            picture = draw_map(
                choice.game_map,
                width=width,
                storey=storey,
                locations=locations,
                center=center,
                span=span,
                title=choice.title,
            )
    except MapError as error:
        raise UserError(str(error), exit_code=2) from None
    console.print(save(picture, path), soft_wrap=True)


def _suffix(
    storey: int | None, locations: bool, center: tuple[float, float] | None, span: float | None
) -> str:
    """Return what a picture shows of its map, as a part of its file name."""
    parts = (
        "" if storey is None else f"-storey-{storey}",
        "-locations" if locations else "",
        "" if center is None else f"-center-{center[0]:g}-{center[1]:g}",
        "" if span is None else f"-span-{span:g}",
    )
    return "".join(parts)


@app.command(cls=MapCommand)
@takes(MapOptions)
def export(
    named: MapOptions,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Folder to write into. Default: map-NAME.")
    ] = None,
) -> None:
    """Write a map's triangle mesh (OBJ and GLB), its valid locations and its spec (JSON)."""
    from wildscav.terminal.console import console, error_console
    from wildscav_engine.maps.export.files import export_map

    if output is not None:
        check_folder("--output", output)
    choice = named.choose()
    folder = output or Path(choice.slug)
    with error_console.status("exporting"):
        paths = export_map(choice.game_map, folder)
    lines = [f"{path}: {path.stat().st_size / 1e6:.2f} MB" for path in paths]
    console.print(*lines, sep="\n", markup=False, highlight=False, soft_wrap=True)


@app.command(cls=MapCommand)
@takes(MapOptions)
def info(named: MapOptions, as_json: AsJson = False) -> None:
    """Print statistics of a map."""
    from wildscav.terminal.console import console, print_json
    from wildscav_engine.simulation.map_statistics import map_statistics

    choice = named.choose()
    statistics = map_statistics(choice.game_map) | {"made in": f"{_generation_time(choice.game_map):.2f} s"}
    console.print(_table(choice.title, statistics))
    if as_json:
        print_json({"map": choice.title, "figures": statistics})


def _table(title: str, statistics: dict[str, str]) -> "Table":
    from wildscav.terminal.tables import FittingTable

    table = FittingTable(title)
    table.add_column("", style="bold")
    table.add_column("")
    for name, value in statistics.items():
        table.add_row(name, value)
    return table


def _generation_time(game_map: "GameMap") -> float:
    """Generate a map again, now that all code is loaded, and return how long that takes, s."""
    from wildscav_engine.maps import generate_map

    began = time.perf_counter()
    generate_map(game_map.config, game_map.spec.seed)
    return time.perf_counter() - began
