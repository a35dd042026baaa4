"""The part of ``wildscav map import`` that reads an untrusted file, in a process with limits.

Everything that it needs is imported here, before the limits are set.
"""

from collections import Counter
from pathlib import Path

import PIL.Image
import PIL.PngImagePlugin
import scipy.spatial
import trimesh

from wildscav.errors import UserError
from wildscav_engine.maps.base import Base, BaseError, save_base
from wildscav_engine.maps.importing import import_height_map, import_mesh

__all__ = ["PIL", "import_file", "scipy", "trimesh"]


def import_file(
    file: str,
    size: int | None,
    lowest: float | None,
    highest: float | None,
    water: float | None,
    name: str | None,
    in_place: bool,
) -> list[str]:
    """Import a height map (if heights are given) or a mesh, and return the lines to print.

    Raises:
        UserError: It cannot be imported.
    """
    path = Path(file)
    try:
        if size is not None and highest is not None:
            imported = import_height_map(path, size, lowest or 0.0, highest, water_level=water, name=name)
        else:
            imported = import_mesh(path, size=size, water_level=water, name=name, centered=not in_place)
        digest, saved = save_base(imported.base)
    except BaseError as error:
        raise UserError(str(error)) from None
    return [
        f"{saved}: {saved.stat().st_size / 1e3:.0f} kB",
        _describe(imported.base),
        *(f"note: {note}" for note in imported.notes),
        "To use it, write into the config of a map:",
        f'  base = "{digest}"',
        f"  size = {imported.base.size}",
    ]


def _describe(base: Base) -> str:
    """Return one line that describes a base."""
    if base.heights is None:
        ground = "flat ground"
    else:
        ground = f"ground from {base.heights.min():.1f} to {base.heights.max():.1f} m"
    water = f"water at {base.water_level:.1f} m" if base.water_level > float("-inf") else "no water"
    counts = Counter(solid.kind.name.lower() for solid in base.solids)
    kinds = ", ".join(f"{count} {kind}" for kind, count in counts.most_common())
    parts = f"{len(base.solids)} parts" + (f" ({kinds})" if kinds else "")
    return f"{base.name}: {base.size} × {base.size} m, {ground}, {water}, {parts}"
