"""Unit normals of the surfaces that each pixel shows."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.array_tables import Addresses
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.world import CELL
from wildscav_engine.rendering.cameras import Cameras, are_finite
from wildscav_engine.rendering.trace import pack_moving, trace_camera, workspace_for
from wildscav_engine.rendering.tracing.frustum import Camera, nonnegative
from wildscav_engine.rendering.tracing.hit_buffer import NOTHING, HitBuffer, hit_buffer_in, index_in_code
from wildscav_engine.rendering.tracing.packing import Shapes, unpack_shapes
from wildscav_engine.rendering.tracing.scene import Scene
from wildscav_engine.rendering.tracing.solid_intersection import write_entered_faces
from wildscav_engine.rendering.tracing.solids import Solids
from wildscav_engine.rendering.tracing.workspace import read_workspace


def write_normals(scene: Scene, moving: Solids, cameras: Cameras, images: NDArray[np.float32]) -> bool:
    """Write the unit normal of the surface that each ray hits first; rays pass through water to its bed.

    Args:
        scene: The static world.
        moving: The moving solids.
        cameras: N cameras.
        images: (N, H, W, 3) in the axes of the world, written; zeros where a ray hits nothing or starts
            below the ground or in a solid.

    Returns:
        Whether all numbers of the cameras are finite; if not, nothing is written.
    """
    others = pack_moving(moving)
    height, width = images.shape[1:3]
    workspace = workspace_for(scene, height, width, cameras.half_width, others).addresses
    return _write_normals(*cameras, others.numbers, others.indices, workspace, scene.world.heights, images)


# Arrays are passed to this kernel one by one, for the reason given in ``trace.py``.
@kernel
def _write_normals(
    eyes: NDArray[np.float64],
    yaws: NDArray[np.float64],
    pitches: NDArray[np.float64],
    viewers: NDArray[np.int32],
    half_width: float,
    far: float,
    moving_numbers: NDArray[np.float64],
    moving_indices: NDArray[np.int64],
    workspace: Addresses,
    heights: NDArray[np.float64],
    images: NDArray[np.float32],
) -> bool:
    """Implement ``write_normals``; ``heights`` are (R + 1, C + 1) m, of the terrain."""
    if not are_finite(eyes, yaws, pitches):
        return False
    parts, others = read_workspace(workspace), unpack_shapes(moving_numbers, moving_indices)
    solids = unpack_shapes(parts.numbers, parts.indices)
    height, width = images.shape[1:3]
    cameras = Cameras(eyes, yaws, pitches, viewers, half_width, far)
    buffer = hit_buffer_in(width, parts.rays, parts.met, parts.strips)
    for image in range(images.shape[0]):
        camera = trace_camera(parts, others, cameras, image, height, False, buffer)
        for row in range(height):
            _write_row(solids, others, heights, camera, buffer, nonnegative(row * width), images[image, row])
    return True


@inlined_kernel
def _write_row(
    solids: Shapes,
    others: Shapes,
    heights: NDArray[np.float64],
    camera: Camera,
    buffer: HitBuffer,
    start: int,
    line: NDArray[np.float32],
) -> None:
    """Write (W, 3) the normals of a row of pixels, the first of whose rays is ``start``."""
    statics, width = solids.boxes.shape[0], line.shape[0]
    first = 0
    while first < width:
        met, last = buffer.met[start + first], first + 1
        while last < width and buffer.met[start + last] == met:
            last += 1
        part = line[first:last]
        if met < NOTHING:
            _fill(part, _normal_of_ground(heights, index_in_code(met)))
        elif met == NOTHING:
            _fill(part, (0.0, 0.0, 0.0))
        elif met < statics:
            _write_solid(solids, met, camera, buffer, start + first, part)
        else:
            _write_solid(others, met - statics, camera, buffer, start + first, part)
        for column in range(first, last):
            if buffer.distance[start + column] == 0.0:
                line[column, 0] = line[column, 1] = line[column, 2] = 0.0
        first = last


@inlined_kernel
def _write_solid(
    shapes: Shapes, solid: int, camera: Camera, buffer: HitBuffer, start: int, part: NDArray[np.float32]
) -> None:
    """Write (C, 3) the normals of the faces through which successive rays enter a solid."""
    # The codes of these rays are not needed anymore, so the faces take their place.
    faces = buffer.met[start : start + part.shape[0]]
    write_entered_faces(shapes, solid, camera, start, shapes.face_start[solid], buffer, faces)
    for column in range(part.shape[0]):
        normal = shapes.faces[faces[column]]
        part[column, 0], part[column, 1], part[column, 2] = normal[0], normal[1], normal[2]


@inlined_kernel
def _fill(part: NDArray[np.float32], normal: tuple[float, float, float]) -> None:
    for column in range(part.shape[0]):
        part[column, 0], part[column, 1], part[column, 2] = normal


@inlined_kernel
def _normal_of_ground(heights: NDArray[np.float64], triangle: int) -> tuple[float, float, float]:
    """Return the unit normal of a triangle of the terrain, numbered as in ``Hits``."""
    columns = heights.shape[1] - 1
    cell, half = triangle // 2, triangle % 2
    row, column = cell // columns, cell % columns
    h00, h01 = heights[row, column], heights[row, column + 1]
    h10, h11 = heights[row + 1, column], heights[row + 1, column + 1]
    south_east = half == 0
    east = (h01 - h00 if south_east else h11 - h10) / CELL
    north = (h11 - h01 if south_east else h10 - h00) / CELL
    length = np.sqrt(east * east + 1.0 + north * north)
    return -east / length, 1.0 / length, -north / length
