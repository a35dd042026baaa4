"""``wildscav map``: draw, describe, export and import maps."""

import time
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

from wildscav.cli.main import Commands
from wildscav.cli.shared_options import AsJson, takes
from wildscav.errors import UserError
from wildscav.system.output_folders import check_folder
from wildscav_inspect.map_options import MapCommand, MapOptions, format_of, save

if TYPE_CHECKING:
    from rich.table import Table

    from wildscav_engine.maps import GameMap

app = typer.Typer(
    name="map",
    cls=Commands,
    help="Draw, describe, make, export and import maps.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)
READER = "wildscav_inspect.limited_import:import_file"
# What the reader needs. This process does not import it, because it only waits for the reader.
MODULES = ("numba", "PIL", "scipy", "trimesh")


@app.command("import")
def import_map(
    file: Annotated[
        Path,
        typer.Argument(
            help="Height map (PNG, grey, 8 or 16 bits) or mesh of convex parts (GLB, OBJ; metres, y up).",
            metavar="FILE",
            show_default=False,
        ),
    ],
    size: Annotated[
        int | None,
        typer.Option(
            help="Metres along each side, an even number. Default: the smallest that holds the mesh."
        ),
    ] = None,
    lowest: Annotated[float | None, typer.Option(help="Height of black in metres. Default: 0.")] = None,
    highest: Annotated[float | None, typer.Option(help="Height of white in metres.")] = None,
    water: Annotated[
        float | None,
        typer.Option(help="Level of the lakes in metres. Default: the level of the mesh's part named water."),
    ] = None,
    name: Annotated[str | None, typer.Option(help="Name of the base. Default: the file's name.")] = None,
    in_place: Annotated[
        bool, typer.Option("--in-place", help="Leave a mesh where it is instead of centring it.")
    ] = False,
) -> None:
    """Import a height map or a mesh as the base of maps, and print what to write into their config.

    The name of a mesh's part says what it is: wall, floor, stair, roof, trunk, crown, rock, furniture or
    bush; terrain or ground is the ground, and water gives the level of the lakes.
    """
    from wildscav.system.limited_process import LimitExceededError, call_limited
    from wildscav.terminal.console import console, error_console, printable

    is_picture = file.suffix.lower() == ".png"
    if is_picture and (size is None or highest is None or in_place):
        raise UserError("a height map needs --size and --highest, and cannot be left --in-place", exit_code=2)
    if not is_picture and (lowest is not None or highest is not None):
        raise UserError("--lowest and --highest are for height maps (PNG)", exit_code=2)
    for module in MODULES:
        if find_spec(module) is None:
            raise ModuleNotFoundError(f"No module named {module!r}", name=module)
    given = (size, lowest, highest, water, name, in_place)
    try:
        with error_console.status(f"reading {escape(file.name)}"):
            lines = call_limited(READER, str(file), *given)
    except LimitExceededError as error:
        raise UserError(f"{file} cannot be imported: {error}") from None
    console.print(*map(printable, lines), sep="\n")


@app.command(cls=MapCommand)
@takes(MapOptions)
def show(
    named: MapOptions,
    output: Annotated[
        Path | None, typer.Option("--out", "-o", help="File to write. Default: map-NAME.png.")
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
    console.print(save(picture, path))


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
        Path | None, typer.Option("--out", "-o", help="Folder to write into. Default: map-NAME.")
    ] = None,
) -> None:
    """Write a map's triangle mesh (OBJ and GLB), its valid locations and its spec (JSON)."""
    from wildscav.terminal.console import console, error_console
    from wildscav_engine.maps.export.files import export_map

    if output is not None:
        check_folder("--out", output)
    choice = named.choose()
    folder = output or Path(choice.slug)
    with error_console.status("exporting"):
        paths = export_map(choice.game_map, folder)
    lines = [f"{path}: {path.stat().st_size / 1e6:.2f} MB" for path in paths]
    console.print(*lines, sep="\n")


@app.command(cls=MapCommand)
@takes(MapOptions)
def info(named: MapOptions, as_json: AsJson = False) -> None:
    """Print statistics of a map.

    With --json: `map`, and `figures`, each as text.
    """
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
