"""What the rays of cameras meet first.

All rays of an image start at one eye, so the image is made thing by thing rather than ray by ray: blocks of
cells from near to far, in each the cells and solids that can lie on a pixel, and these meet the rays of just
those pixels. What cannot be nearer than what is already there is passed over. Each ray's answer is the
nearest of the same meetings, computed in the same way, whichever image it is part of.
"""

from collections.abc import Callable, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.array_tables import Addresses
from wildscav_engine.compilation.kernel import inlined_kernel, kernel, only_for
from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT
from wildscav_engine.rendering.cameras import Cameras, are_finite
from wildscav_engine.rendering.tracing.bodies import entered_face
from wildscav_engine.rendering.tracing.canvas import (
    NOTHING,
    Canvas,
    canvas_on,
    index_of,
    is_of_terrain,
    start,
)
from wildscav_engine.rendering.tracing.frustum import Camera, camera_at
from wildscav_engine.rendering.tracing.image import Desk, look_at_things, look_at_world
from wildscav_engine.rendering.tracing.packing import (
    Packed,
    Shapes,
    pack_nothing,
    pack_shapes,
    unpack_blocks,
    unpack_shapes,
)
from wildscav_engine.rendering.tracing.scene import Scene, scene_of
from wildscav_engine.rendering.tracing.solids import Solids, all_shapes_of
from wildscav_engine.rendering.tracing.workspace import Room, Size, read_room

__all__ = [
    "WATER_HIT",
    "Hits",
    "Scene",
    "allocate_hits",
    "depths_tracer",
    "scene_of",
    "trace",
    "trace_depths",
    "trace_depths_of_maps",
]

WATER_HIT = -3
NOBODY = -2  # who looks


class Hits(NamedTuple):
    """What each ray of N images met."""

    distance: NDArray[np.float32]  # (N, H, W) m along the ray, inf where nothing is met
    solid: NDArray[np.int32]  # (N, H, W) see below
    face: NDArray[np.int32]  # (N, H, W) see below

    # solid: index of the world's solid; from the number of these on, of the moving ones; TERRAIN_HIT,
    # WATER_HIT or NOTHING_HIT.
    # face: index into Solids.faces of the world or the moving ones; for terrain 2 * cell + 0 for its
    # south-eastern triangle, + 1 for the other; for water the cell (row * columns + column); else 0.


def allocate_hits(count: int, height: int, width: int) -> Hits:
    """Return room for the hits of some images."""
    shape = (count, height, width)
    return Hits(np.empty(shape, np.float32), np.empty(shape, np.int32), np.empty(shape, np.int32))


def _pack(moving: Solids) -> Packed:
    return pack_shapes(all_shapes_of(moving)) if len(moving.kind) else NOTHING_MOVES


NOTHING_MOVES = pack_nothing()


def trace(scene: Scene, moving: Solids, cameras: Cameras, hits: Hits, *, with_water: bool = False) -> bool:
    """Find what each ray meets first.

    Args:
        scene: The static world.
        moving: What is in it besides.
        cameras: N cameras. One outside the map sees nothing of it; one below the ground or in a solid meets
            that at distance 0.
        hits: Of N images, written.
        with_water: Whether rays meet the surface of water; else they go to its bed.

    Returns:
        Whether all cameras are finite numbers; else nothing is written.
    """
    others = _pack(moving)
    _, height, width = hits.distance.shape
    room = scene.rooms.of(scene.packed, Size(height, width, cameras.half_width, others.most_faces))
    return _trace_hits(with_water, *cameras, others.numbers, others.indices, room.addresses, *hits)


def trace_depths(scene: Scene, moving: Solids, cameras: Cameras, depths: NDArray[np.float32]) -> bool:
    """Find how far along the view axis each ray meets something; what is given is as in ``trace``.

    Args:
        scene: The static world.
        moving: What is in it besides.
        cameras: N cameras.
        depths: (N, H, W) m, written: the cameras' far where nothing is met.

    Returns:
        Whether all cameras are finite numbers; else nothing is written.
    """
    others = _pack(moving)
    _, height, width = depths.shape
    room = scene.rooms.of(scene.packed, Size(height, width, cameras.half_width, others.most_faces))
    tables = room.with_moving(others, cameras.viewers) if len(moving.kind) else room.tables
    eyes, yaws, pitches, _, half_width, far = cameras
    return _trace_depths(eyes, yaws, pitches, half_width, far, tables, depths)


def trace_depths_of_maps(
    scenes: Sequence[Scene], size: Size, cameras: Cameras, depths: NDArray[np.float32]
) -> bool:
    """Do what ``trace_depths`` does where nothing moves, for N cameras on N worlds, which may be the same."""
    rooms = [scene.rooms.kept.get(size) or scene.rooms.make(scene.packed, size) for scene in scenes]
    tables = rooms[0].tables if len(rooms) == 1 else np.concatenate([room.tables for room in rooms])
    eyes, yaws, pitches, _, half_width, far = cameras
    return _trace_depths(eyes, yaws, pitches, half_width, far, tables, depths)


# What stays the same between calls comes to these kernels as a table of arrays; what does not, one by one:
# from Python, a tuple of arrays takes several times longer.


@kernel
def _trace_hits(
    with_water: bool,
    eyes: NDArray[np.float64],
    yaws: NDArray[np.float64],
    pitches: NDArray[np.float64],
    viewers: NDArray[np.int32],
    half_width: float,
    far: float,
    moving_numbers: NDArray[np.float64],
    moving_indices: NDArray[np.int64],
    room: Addresses,
    distance: NDArray[np.float32],
    solid: NDArray[np.int32],
    face: NDArray[np.int32],
) -> bool:
    """Do what ``trace`` says."""
    if not are_finite(eyes, yaws, pitches):
        return False
    parts = read_room(room)
    others = unpack_shapes(moving_numbers, moving_indices)
    solids = unpack_shapes(parts.numbers, parts.indices)
    height, width = distance.shape[1:]
    canvas = canvas_on(width, parts.rays, parts.met, parts.strips)
    for image in range(yaws.shape[0]):
        camera = camera_at(eyes[image], yaws[image], pitches[image], half_width, width, height, far)
        _look(parts, others, camera, viewers[image], with_water, canvas)
        hit = Hits(distance[image], solid[image], face[image])
        _write_hits(solids, others, camera, canvas, hit)
    return True


@kernel
def _trace_depths(
    eyes: NDArray[np.float64],
    yaws: NDArray[np.float64],
    pitches: NDArray[np.float64],
    half_width: float,
    far: float,
    rooms: NDArray[np.int64],
    depths: NDArray[np.float32],
) -> bool:
    """Do what ``trace_depths`` says, in one room or in one for each image.

    Shapes that do not agree are refused, too, so that those who are in a hurry need not look at them.
    """
    count, height, width = depths.shape
    is_whole = eyes.shape[0] == yaws.shape[0] == pitches.shape[0] == count and eyes.shape[1] == 3
    if not (is_whole and are_finite(eyes, yaws, pitches)):
        return False
    for image in range(count):
        parts = read_room(rooms[image if rooms.shape[0] > 1 else 0])
        canvas = canvas_on(width, parts.rays, parts.met, parts.strips)
        camera = camera_at(eyes[image], yaws[image], pitches[image], half_width, width, height, far)
        others = unpack_shapes(parts.moving_numbers, parts.moving_indices)
        viewer = parts.viewers[image] if others.boxes.shape[0] > 0 else NOBODY
        _look(parts, others, camera, viewer, False, canvas)
        _write_depths(canvas, depths[image])
    return True


@cache
def depths_tracer() -> Callable[..., bool]:
    """Return the shortest way to depths, for arrays that are just right.

    A small image takes hardly longer than looking at three arrays in Python, and handing them on. So here
    the kernel itself finds out whether it can take what it is given. Where shapes do not agree, or a number
    is not finite, it writes nothing and returns False; for what is no array of its type, in order, aligned
    and writable, it raises TypeError, ValueError or NumbaError.

    Args of what is returned: (N, 3) float64 m, the eyes; (N,) float64 degrees, yaws; (N,) float64 degrees,
    pitches; the half width and the reach of ``Cameras``; tables of one room or N; (N, H, W) float32, written.
    """
    numbers, depths = np.zeros(1), np.zeros((1, 1, 1), np.float32)
    tables = np.zeros((1, 1, 1), np.int64)
    return only_for(_trace_depths, numbers[None], numbers, numbers, 1.0, 1.0, tables, depths)


@inlined_kernel
def _look(parts: Room, others: Shapes, camera: Camera, viewer: int, with_water: bool, canvas: Canvas) -> None:
    """Make one image on a canvas."""
    blocks = unpack_blocks(parts.numbers, parts.indices, parts.halves)
    solids = unpack_shapes(parts.numbers, parts.indices)
    desk = Desk(
        parts.sketch,
        parts.boxes,
        parts.outside,
        parts.shown,
        parts.queue,
        parts.rings,
        parts.cells,
        parts.done,
    )
    start(canvas, camera)
    look_at_world(blocks, solids, camera, with_water, desk, canvas)
    look_at_things(others, solids.boxes.shape[0], camera, viewer, desk.outside, canvas)


@inlined_kernel
def _write_depths(canvas: Canvas, depths: NDArray[np.float32]) -> None:
    for row in range(depths.shape[0]):
        line, first = depths[row], row * canvas.width
        last = first + canvas.width
        distance, met, along = canvas.distance[first:last], canvas.met[first:last], canvas.along[first:last]
        for column in range(canvas.width):
            line[column] = distance[column] * (along[column] if met[column] != NOTHING else 1.0)


@kernel
def _write_hits(solids: Shapes, others: Shapes, camera: Camera, canvas: Canvas, hit: Hits) -> None:
    """Say what each ray of an image met, in the numbers of ``Hits``, all (H, W)."""
    height, width = hit.distance.shape
    for row in range(height):
        for column in range(width):
            ray = row * width + column
            met = canvas.met[ray]
            distance, solid, face = canvas.distance[ray], NOTHING_HIT, 0
            if met == NOTHING:
                distance = np.inf
            elif met < NOTHING:
                solid = TERRAIN_HIT if is_of_terrain(met) else WATER_HIT
                face = index_of(met)
            else:
                way = (canvas.east[ray], canvas.up[ray], canvas.north[ray])
                if met < solids.boxes.shape[0]:
                    solid = solids.names[met]
                    face = solids.face_names[met] + entered_face(solids, met, camera, way)
                else:
                    thing = met - solids.boxes.shape[0]
                    solid = solids.boxes.shape[0] + thing
                    face = others.face_names[thing] + entered_face(others, thing, camera, way)
            hit.distance[row, column] = distance
            hit.solid[row, column] = solid
            hit.face[row, column] = face
