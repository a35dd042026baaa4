"""``wildscav map import``: bring in a height map or a triangle mesh as a map of one's own."""

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

from wildscav.errors import UserError

if TYPE_CHECKING:
    from wildscav_engine.maps.base import Base
    from wildscav_engine.maps.importing import Imported


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
        typer.Option(help="Level of the lakes in metres. Default: that of a mesh's part called water."),
    ] = None,
    name: Annotated[str | None, typer.Option(help="What to call it. Default: the file's name.")] = None,
    in_place: Annotated[
        bool, typer.Option("--in-place", help="Leave a mesh where it is instead of centring it.")
    ] = False,
) -> None:
    """Bring in a height map or a mesh to make maps on, and print what to write into their config.

    Parts of a mesh are what their names say: wall, floor, stair, roof, trunk, crown, rock, furniture or bush;
    terrain or ground is the ground, water the level of the lakes.
    """
    from wildscav.console import error_console
    from wildscav_engine.maps.base import BaseError, save_base
    from wildscav_engine.maps.importing import import_height_map, import_mesh

    is_picture = file.suffix.lower() == ".png"
    try:
        with error_console.status(f"reading {escape(file.name)}"):
            if is_picture:
                if size is None or highest is None or in_place:
                    raise UserError(
                        "a height map needs --size and --highest, and cannot be left --in-place", exit_code=2
                    )
                imported = import_height_map(file, size, lowest or 0.0, highest, water_level=water, name=name)
            else:
                if lowest is not None or highest is not None:
                    raise UserError("--lowest and --highest are for height maps (PNG)", exit_code=2)
                imported = import_mesh(file, size=size, water_level=water, name=name, centered=not in_place)
            digest, path = save_base(imported.base)
    except BaseError as error:
        raise UserError(str(error)) from None
    _report(imported, digest, path)


def _report(imported: "Imported", digest: str, path: Path) -> None:
    from wildscav.console import console, printable

    base = imported.base
    lines = [f"{path}: {path.stat().st_size / 1e3:.0f} kB", _describe(base)]
    lines += [f"note: {note}" for note in imported.notes]
    lines += ["In the config of a map on it:", f'  base = "{digest}"', f"  size = {base.size}"]
    console.print(*map(printable, lines), sep="\n", markup=False, highlight=False, soft_wrap=True)


def _describe(base: "Base") -> str:
    """Return one line on what a base holds."""
    if base.heights is None:
        ground = "flat ground"
    else:
        ground = f"ground from {base.heights.min():.1f} to {base.heights.max():.1f} m"
    water = f"water at {base.water_level:.1f} m" if base.water_level > float("-inf") else "no water"
    counts = Counter(solid.kind.name.lower() for solid in base.solids)
    kinds = ", ".join(f"{count} {kind}" for kind, count in counts.most_common())
    parts = f"{len(base.solids)} parts" + (f" ({kinds})" if kinds else "")
    return f"{base.name}: {base.size} × {base.size} m, {ground}, {water}, {parts}"
