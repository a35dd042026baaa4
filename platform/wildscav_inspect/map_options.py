"""Options with which commands name a map: its number, or a config and a seed."""

import json
import tomllib
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer
from typer.core import TyperCommand

from wildscav.errors import UserError

if TYPE_CHECKING:
    from PIL.Image import Image

    from wildscav_engine.maps import GameMap

MAX_IDS = 999

MapId = Annotated[
    int | None,
    typer.Argument(help="Number of a map, 1 to 999, such as 014.", metavar="[ID]", show_default=False),
]
Seed = Annotated[int | None, typer.Option(help="Generate the map from a config and this seed instead.")]
ConfigFile = Annotated[
    Path | None,
    typer.Option("--config", help="JSON or TOML file with the fields of a MapConfig or a MapSpec."),
]
Size = Annotated[int | None, typer.Option(help="Metres along each side, 40 to 2000.")]
Relief = Annotated[float | None, typer.Option(help="0 flat, 1 hills, 2 mountains.")]
Ruggedness = Annotated[float | None, typer.Option(help="0 downs and plains, 1 ridges and cliffs.")]
Water = Annotated[float | None, typer.Option(help="Share of the area under lakes, 0 to 0.4.")]
Houses = Annotated[int | None, typer.Option(help="Number of houses, 0 to 200.")]
Density = Annotated[str | None, typer.Option(help="low: houses scattered; high: close together.")]
Storeys = Annotated[
    str | None, typer.Option(help="Storeys of the houses: a number from 1 to 4, or a range such as 1-3.")
]
Vegetation = Annotated[float | None, typer.Option(help="0 bare, 1 dense woods.")]


class Choice(NamedTuple):
    """A map and its title."""

    game_map: "GameMap"
    title: str
    details: str = ""  # the options that it was made with, such as "-size-300-houses-20"

    @property
    def slug(self) -> str:
        """The map's name in file names; different maps have different names."""
        return self.title.lower().replace(" ", "-") + self.details


class MapCommand(TyperCommand):
    """A command that takes a map. A negative number is reported as an ID out of range, not as an option."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the command line, or raise a UserError if the ID is a negative number."""
        given = list(args)
        try:
            return super().parse_args(ctx, args)
        except Exception as error:
            option = getattr(error, "option_name", "")  # of Typer's own error for an unknown option
            negative = [text for text in given if text.startswith(option) and text[1:].isdigit()]
            if option[1:].isdigit() and negative:
                raise UserError(f"ID is {negative[0]}, must be 1 to {MAX_IDS}", exit_code=2) from None
            raise


@dataclass(frozen=True)
class MapOptions:
    """The options that name a map."""

    map_id: MapId = None
    seed: Seed = None
    config: ConfigFile = None
    size: Size = None
    relief: Relief = None
    ruggedness: Ruggedness = None
    water: Water = None
    houses: Houses = None
    density: Density = None
    storeys: Storeys = None
    vegetation: Vegetation = None

    def choose(self) -> Choice:
        """Return the map that the command line names; a UserError if there is none or it cannot be made."""
        fields = {name: value for name, value in vars(self).items() if value is not None}
        map_id, seed, config = (fields.pop(name, None) for name in ("map_id", "seed", "config"))
        if self.storeys is not None:
            fields["storeys"] = _read_storeys(self.storeys)
        if (map_id is not None) == (seed is not None or config is not None or bool(fields)):
            also = "one of them is needed" if map_id is None else "not both"
            raise UserError(
                f"a map is named by its ID, or by --seed, --config and the fields of a config: {also}",
                exit_code=2,
            )
        if map_id is not None and not 1 <= map_id <= MAX_IDS:
            raise UserError(f"ID is {map_id}, must be 1 to {MAX_IDS}", exit_code=2)
        return _make(map_id, seed, config, fields)


def _make(map_id: int | None, seed: int | None, file: Path | None, fields: dict[str, Any]) -> Choice:
    """Return the map with an ID, or else the map of a config and a seed."""
    from pydantic import ValidationError

    from wildscav.terminal.console import error_console
    from wildscav_engine.maps import MapError, generate_map, load_map
    from wildscav_engine.specs.map_spec import MapSpec
    from wildscav_engine.specs.validation import one_line

    try:
        with error_console.status("making the map"):
            if map_id is not None:
                return Choice(load_map(map_id), f"Map {map_id:03}")
            spec = MapSpec.model_validate(_spec_fields(seed, file, fields))
            title = f"Map {file.stem}" if file else f"Seed {spec.seed}"
            options = fields | ({"seed": seed} if file and seed is not None else {})
            return Choice(generate_map(spec.config, spec.seed), title, _details(options))
    except ValidationError as error:
        raise UserError(_without_config(one_line(error)), exit_code=2) from None
    except MapError as error:
        raise UserError(str(error), exit_code=2) from None


def _details(options: dict[str, Any]) -> str:
    """Return options and their values as a part of a file name."""
    values = {name: value if isinstance(value, tuple) else (value,) for name, value in options.items()}
    return "".join(f"-{name}-{'-'.join(map(str, several))}" for name, several in values.items())


def _read_storeys(text: str) -> tuple[int, int]:
    low, _, high = text.partition("-")
    try:
        return int(low), int(high or low)
    except ValueError:
        raise UserError(
            f"storeys is {text!r}, must be a number from 1 to 4, or a range such as 1-3", exit_code=2
        ) from None


def _without_config(message: str) -> str:
    """Return an error with fields named like the options, without the prefix that they have in a spec."""
    return "; ".join(part.removeprefix("config.") for part in message.split("; "))


def _spec_fields(seed: int | None, file: Path | None, fields: dict[str, Any]) -> dict[str, Any]:
    """Return the fields of a MapSpec: those of the options take precedence over those of the file."""
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
    from wildscav_inspect.config_files import read_config

    return _parsed_config(file, read_config(file, f"{__name__}:try_config"))


def try_config(file: str) -> None:
    """Parse a config in the calling process, on trial.

    Raises:
        UserError: It is invalid.
        OSError: It cannot be read.
    """
    from wildscav_engine.storage.files import read_limited
    from wildscav_inspect.config_files import LARGEST

    _parsed_config(Path(file), read_limited(Path(file), LARGEST))


def _parsed_config(file: Path, content: bytes) -> dict[str, Any]:
    try:
        text = content.decode()
        read = tomllib.loads(text) if file.suffix.lower() == ".toml" else json.loads(text)
    except RecursionError:
        raise UserError(f"{file}: it is nested too deeply", exit_code=2) from None
    except ValueError as error:
        raise UserError(f"{file}: {error}", exit_code=2) from None
    if not isinstance(read, dict):
        raise UserError(f"{file} must hold the fields of a MapConfig or a MapSpec", exit_code=2)
    return read


def format_of(path: Path) -> str:
    """Return the picture format of a file by its name."""
    formats = {".png": "PNG", ".jpg": "JPEG", ".jpeg": "JPEG", ".webp": "WEBP"}
    if path.suffix.lower() not in formats:
        raise UserError(f"{path} must end in one of {', '.join(formats)}", exit_code=2)
    return formats[path.suffix.lower()]


def save(picture: "Image", path: Path) -> str:
    """Write a picture in the format of its file name; no partial file is left behind.

    Returns:
        A line that says what was written, and whether it replaced another file.
    """
    replaced = ", replacing the file that was there" if path.exists() else ""
    from wildscav_engine.storage.files import write_whole

    content = BytesIO()
    picture.save(content, format_of(path), quality=90, optimize=True)
    write_whole(path, content.getvalue())
    return f"{path}: {picture.width} × {picture.height} pixels{replaced}"
