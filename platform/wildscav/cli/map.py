"""``wildscav map``: look at maps, export them, bring in others."""

import json
import time
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer
from rich.markup import escape

from wildscav.cli.map_import import import_map
from wildscav.errors import UserError

if TYPE_CHECKING:
    from wildscav_engine.maps import GameMap

app = typer.Typer(
    name="map",
    help="Look at maps, export them, and bring in others.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)
app.command("import")(import_map)

LARGEST_FILE = 10_000_000  # bytes, of a config
MOST_IDS = 999

MapId = Annotated[
    int | None,
    typer.Argument(help="Number of a map, 1 to 999, such as 014.", metavar="[ID]", show_default=False),
]
Seed = Annotated[int | None, typer.Option(help="Make the map of a config and this seed instead.")]
ConfigFile = Annotated[
    Path | None,
    typer.Option("--config", help="JSON or TOML file with the fields of a MapConfig or a MapSpec."),
]
Size = Annotated[int | None, typer.Option(help="Metres along each side, 40 to 2000.")]
Relief = Annotated[float | None, typer.Option(help="0 flat, 1 hills, 2 mountains.")]
Ruggedness = Annotated[float | None, typer.Option(help="0 downs and plains, 1 ridges and cliffs.")]
Water = Annotated[float | None, typer.Option(help="Share of the area under lakes, 0 to 0.4.")]
Houses = Annotated[int | None, typer.Option(help="How many, 0 to 200.")]
Density = Annotated[str | None, typer.Option(help="low: houses scattered; high: close together.")]
Storeys = Annotated[str | None, typer.Option(help="Of the houses: a number from 1 to 4, or two, as 1-3.")]
Vegetation = Annotated[float | None, typer.Option(help="0 bare, 1 dense woods.")]


class Choice(NamedTuple):
    """A map, and what to call it."""

    game_map: "GameMap"
    title: str


@app.command()
def show(
    map_id: MapId = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="File to write. Default: map-NAME.png.")
    ] = None,
    width: Annotated[int, typer.Option(help="Pixels.")] = 1200,
    storey: Annotated[
        int | None, typer.Option(help="Cut the houses open at this storey; 1 is the ground floor.")
    ] = None,
    locations: Annotated[bool, typer.Option("--locations", help="Mark the valid locations.")] = False,
    center: Annotated[
        tuple[float, float] | None, typer.Option(help="x and z in metres of the middle of the picture.")
    ] = None,
    span: Annotated[
        float | None, typer.Option(help="Metres that the picture shows from west to east.")
    ] = None,
    seed: Seed = None,
    config: ConfigFile = None,
    size: Size = None,
    relief: Relief = None,
    ruggedness: Ruggedness = None,
    water: Water = None,
    houses: Houses = None,
    density: Density = None,
    storeys: Storeys = None,
    vegetation: Vegetation = None,
) -> None:
    """Draw a map from above: relief, water, vegetation, and houses by their storeys or cut open."""
    from wildscav.console import console, error_console
    from wildscav_engine.maps import MapError
    from wildscav_engine.maps.picture import draw_map

    fields = _fields(size, relief, ruggedness, water, houses, density, storeys, vegetation)
    choice = _choose(map_id, seed, config, fields)
    path = output or Path(f"{choice.title.lower().replace(' ', '-')}.png")
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
    _save(picture, path)
    console.print(
        f"{path}: {picture.width} × {picture.height} pixels", markup=False, highlight=False, soft_wrap=True
    )


def format_of(path: Path) -> str:
    """Return the picture format that a file's name asks for."""
    formats = {".png": "PNG", ".jpg": "JPEG", ".jpeg": "JPEG", ".webp": "WEBP"}
    if path.suffix.lower() not in formats:
        raise UserError(f"{path} must end in one of {', '.join(formats)}", exit_code=2)
    return formats[path.suffix.lower()]


def _save(picture: Any, path: Path) -> None:
    from io import BytesIO

    from wildscav_engine.files import write_whole

    content = BytesIO()
    picture.save(content, format_of(path), quality=90, optimize=True)
    write_whole(path, content.getvalue())


@app.command()
def export(
    map_id: MapId = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Folder to write into. Default: map-NAME.")
    ] = None,
    seed: Seed = None,
    config: ConfigFile = None,
    size: Size = None,
    relief: Relief = None,
    ruggedness: Ruggedness = None,
    water: Water = None,
    houses: Houses = None,
    density: Density = None,
    storeys: Storeys = None,
    vegetation: Vegetation = None,
) -> None:
    """Write a map's triangle mesh (OBJ and GLB), its valid locations and what it is made from (JSON)."""
    from wildscav.console import console, error_console
    from wildscav_engine.maps.export import export_map

    fields = _fields(size, relief, ruggedness, water, houses, density, storeys, vegetation)
    choice = _choose(map_id, seed, config, fields)
    folder = output or Path(choice.title.lower().replace(" ", "-"))
    with error_console.status("exporting"):
        paths = export_map(choice.game_map, folder)
    lines = [f"{path}: {path.stat().st_size / 1e6:.2f} MB" for path in paths]
    console.print(*lines, sep="\n", markup=False, highlight=False, soft_wrap=True)


@app.command()
def info(
    map_id: MapId = None,
    seed: Seed = None,
    config: ConfigFile = None,
    size: Size = None,
    relief: Relief = None,
    ruggedness: Ruggedness = None,
    water: Water = None,
    houses: Houses = None,
    density: Density = None,
    storeys: Storeys = None,
    vegetation: Vegetation = None,
) -> None:
    """Print a map's figures."""
    from rich import box
    from rich.table import Table

    from wildscav.console import console
    from wildscav_engine.maps.figures import figures_of

    fields = _fields(size, relief, ruggedness, water, houses, density, storeys, vegetation)
    choice = _choose(map_id, seed, config, fields)
    table = Table(
        box=box.SIMPLE_HEAD,
        padding=(0, 2, 0, 0),
        show_edge=False,
        title=escape(choice.title),
        title_justify="left",
    )
    table.add_column("", style="bold")
    table.add_column("", overflow="fold")
    for name, figure in figures_of(choice.game_map).items():
        table.add_row(name, escape(figure))
    table.add_row("made in", f"{_seconds_to_make(choice.game_map):.2f} s")
    console.print(table)


def _seconds_to_make(game_map: "GameMap") -> float:
    """Make a map once more, with all code loaded, and return how long that takes."""
    from wildscav_engine.maps import generate_map

    began = time.perf_counter()
    generate_map(game_map.config, game_map.spec.seed)
    return time.perf_counter() - began


def _fields(
    size: int | None,
    relief: float | None,
    ruggedness: float | None,
    water: float | None,
    houses: int | None,
    density: str | None,
    storeys: str | None,
    vegetation: float | None,
) -> dict[str, Any]:
    """Return the fields of a MapConfig that were given."""
    given = {
        "size": size,
        "relief": relief,
        "ruggedness": ruggedness,
        "water": water,
        "houses": houses,
        "density": density,
        "storeys": None if storeys is None else _read_storeys(storeys),
        "vegetation": vegetation,
    }
    return {name: value for name, value in given.items() if value is not None}


def _read_storeys(text: str) -> tuple[int, int]:
    low, _, high = text.partition("-")
    try:
        return int(low), int(high or low)
    except ValueError:
        raise UserError(
            f"storeys is {text!r}, must be a number from 1 to 4, or two, as 1-3", exit_code=2
        ) from None


def _choose(map_id: int | None, seed: int | None, file: Path | None, fields: dict[str, Any]) -> Choice:
    """Return the map that the command line names.

    Raises:
        UserError: It names none, or none that can be.
    """
    from pydantic import ValidationError

    from wildscav.console import error_console
    from wildscav_engine.maps import MapError, generate_map, load_map
    from wildscav_engine.spec import MapSpec, one_line

    given = seed is not None or file is not None or bool(fields)
    if (map_id is not None) == given:
        also = "not both" if given else "one of them is needed"
        raise UserError(
            f"a map is named by its ID, or by --seed, --config and the fields of a config: {also}",
            exit_code=2,
        )
    if map_id is not None and not 1 <= map_id <= MOST_IDS:
        raise UserError(f"ID is {map_id}, must be 1 to {MOST_IDS}", exit_code=2)
    try:
        with error_console.status("making the map"):
            if map_id is not None:
                return Choice(load_map(map_id), f"Map {map_id:03}")
            spec = MapSpec.model_validate(_spec_fields(seed, file, fields))
            title = f"Map {file.stem}" if file else f"Seed {spec.seed}"
            return Choice(generate_map(spec.config, spec.seed), title)
    except ValidationError as error:
        raise UserError(_without_config(one_line(error)), exit_code=2) from None
    except MapError as error:
        raise UserError(str(error), exit_code=2) from None


def _without_config(message: str) -> str:
    """Name fields as the options do, not as they stand in a spec."""
    return "; ".join(part.removeprefix("config.") for part in message.split("; "))


def _spec_fields(seed: int | None, file: Path | None, fields: dict[str, Any]) -> dict[str, Any]:
    """Return a MapSpec's fields: those of a file, and over them those of the options."""
    spec: dict[str, Any] = {} if file is None else _read_config(file)
    if not set(spec) <= {"config", "seed"}:
        spec = {"config": spec}
    config = spec.get("config", {})
    if isinstance(config, dict):
        spec["config"] = config | fields
    if seed is not None:
        spec["seed"] = seed
    return spec


def _read_config(file: Path) -> dict[str, Any]:
    if file.stat().st_size > LARGEST_FILE:
        raise UserError(f"{file} is larger than {LARGEST_FILE // 1_000_000} MB", exit_code=2)
    try:
        text = file.read_text("utf-8")
        read = tomllib.loads(text) if file.suffix.lower() == ".toml" else json.loads(text)
    except (ValueError, RecursionError) as error:
        raise UserError(f"{file}: {error}", exit_code=2) from None
    if not isinstance(read, dict):
        raise UserError(f"{file} must hold the fields of a MapConfig or a MapSpec", exit_code=2)
    return read
