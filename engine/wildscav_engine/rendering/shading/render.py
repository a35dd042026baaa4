"""Rendering pictures: the rays of each are traced, and what they hit is shaded.

One kernel renders the pictures of many cameras on many maps, because every call from Python waits for the
other threads that are in Python.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.compilation.tables.array_tables import Addresses, ArrayTable, addresses_of, reader
from wildscav_engine.parallel.turns import ALONE, Turns
from wildscav_engine.rendering.cameras import TAKEN_ALREADY, Cameras, are_finite, item_at
from wildscav_engine.rendering.dynamic_objects import ObjectSets, solids_between
from wildscav_engine.rendering.hits import Hits, write_hits
from wildscav_engine.rendering.shading.appearance import Appearance, Appearances, materials_in, world_in
from wildscav_engine.rendering.shading.coarse_shading import Chosen
from wildscav_engine.rendering.shading.light.ambient_occlusion import LOOKED_AT, Around
from wildscav_engine.rendering.shading.light.moving_shadows import allocate_casters
from wildscav_engine.rendering.shading.pictures import Canvas, Rows, ShadedScene, shade
from wildscav_engine.rendering.shading.pixel_rows import (
    TextureScratch,
    allocate_rows,
    allocate_texture_scratch,
    cosines_of,
)
from wildscav_engine.rendering.trace import Scene, Scenes, flatten_views, objects_in, read_views, trace_view
from wildscav_engine.rendering.tracing.workspace import LatestOfThread, Size

MAX_KEPT = 2**18  # pixels of the largest picture whose scratch buffers are kept for the next one


def render_pictures(
    scenes: Scene | Scenes,
    appearances: Appearance | Appearances,
    objects: ObjectSets,
    matches: NDArray[np.int64],
    cameras: Cameras,
    images: NDArray[np.uint8],
    turns: Turns = ALONE,
    *,
    shadows: bool,
    is_fast: bool,
) -> bool:
    """Write pictures, (N, H, W, 3) red, green, blue; for the rest, see ``images.trace_images``."""
    _, height, width, _ = images.shape
    size = Size(height, width, cameras.half_width, objects.most_faces)
    # Keep the buffers alive during the call: the table holds only their addresses.
    _buffers, scratch = _scratch_for(height, width)
    return _render(
        appearances.tables,
        _casters_for(objects.most).addresses,
        cosines_of(cameras.half_width, height, width),
        scratch,
        shadows,
        is_fast,
        images,
        *flatten_views(scenes, objects, matches, cameras, turns, size),
    )


Scratch = tuple[Hits, Rows, Chosen, Around, TextureScratch]


def _allocate(height: int, width: int) -> Scratch:
    """Return buffers for what the rays of one picture hit, and for its ``Canvas``."""
    shape = height, width
    return (
        Hits(np.empty(shape, np.float32), np.empty(shape, np.int32), np.empty(shape, np.int32)),
        Rows(np.empty(shape, np.float32), allocate_rows(width), np.empty(width + 1, np.int32)),
        Chosen(*np.empty((4, width), np.int32), *np.empty((2, width), np.float32)),
        Around(*np.empty((4, LOOKED_AT), np.float32)),
        allocate_texture_scratch(),
    )


_hits, _rows, _chosen, _around, _texture = _allocate(1, 1)
_read_hits, _read_rows, _read_chosen = reader(_hits), reader(_rows), reader(_chosen)
_read_around, _read_texture = reader(_around), reader(_texture)
ROWS = len(Hits._fields)  # the row of the table of a ``Scratch`` where its second part begins
CHOSEN = ROWS + len(Rows._fields)
AROUND = CHOSEN + len(Chosen._fields)
TEXTURE = AROUND + len(Around._fields)
_read_casters = reader(allocate_casters(1))
_latest_scratch, _latest_casters = LatestOfThread(1), LatestOfThread(1)


def _scratch_for(height: int, width: int) -> tuple[Scratch, Addresses]:
    """Return the buffers for a picture, and the table of their addresses."""

    def make() -> tuple[Scratch, Addresses]:
        parts = _allocate(height, width)
        return parts, np.concatenate([addresses_of(part) for part in parts])

    return make() if height * width > MAX_KEPT else _latest_scratch.get((height, width), make)


def _casters_for(count: int) -> ArrayTable:
    """Return the buffers for the shadows of so many moving solids."""
    rounded = 1 << count.bit_length()
    return _latest_casters.get(rounded, lambda: ArrayTable(allocate_casters(rounded)))


@kernel
def _render(
    appearances: NDArray[np.int64],
    casters: Addresses,
    cosines: NDArray[np.float32],
    scratch: Addresses,
    shadows: bool,
    is_fast: bool,
    images: NDArray[np.uint8],
    *views: Any,
) -> bool:
    """Implement ``render_pictures``."""
    seen = read_views(views)
    cameras, objects = seen.cameras, seen.matches.objects
    if not are_finite(cameras.eyes, cameras.yaws, cameras.pitches):
        return False
    hit = _read_hits(scratch[:ROWS])
    canvas = Canvas(
        _read_rows(scratch[ROWS:CHOSEN]),
        _read_chosen(scratch[CHOSEN:AROUND]),
        _read_around(scratch[AROUND:TEXTURE]),
        _read_texture(scratch[TEXTURE:]),
    )
    count, height, width = images.shape[:3]
    for turn in range(count):
        image = item_at(seen.turns, turn)
        if image == TAKEN_ALREADY:
            continue
        place = image if appearances.shape[0] > 1 else 0
        traced = trace_view(seen, image, height, width, True)
        write_hits(traced, hit)
        first, last = objects_in(seen.matches, image)
        scene = ShadedScene(
            world_in(appearances[place]),
            materials_in(appearances[place]),
            solids_between(objects, first, last),
            objects.color[first:last],
            _read_casters(casters),
            shadows,
            is_fast,
        )
        shade(scene, cameras, image, hit, canvas, cosines, images[image])
    return True
