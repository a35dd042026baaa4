"""``wildscav map import``: import a height map or a triangle mesh as the base of maps."""

from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from wildscav.errors import UserError

READER = "wildscav.cli.maps.limited_import:import_file"
# What the reader needs. This process does not import it, because it only waits for the reader.
MODULES = ("numba", "PIL", "scipy", "trimesh")


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
    console.print(*map(printable, lines), sep="\n", soft_wrap=True)
