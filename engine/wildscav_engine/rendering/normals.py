"""Unit normals of the surfaces that each pixel shows."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.geometry.world import BLOCK, CELL
from wildscav_engine.rendering.trace import TracedImage
from wildscav_engine.rendering.tracing.frustum import Camera, nonnegative
from wildscav_engine.rendering.tracing.hit_buffer import NOTHING, HitBuffer, index_in_code
from wildscav_engine.rendering.tracing.scene_arrays import COLUMNS, CORNERS, Blocks, Shapes
from wildscav_engine.rendering.tracing.solid_intersection import write_entered_faces


@inlined_kernel
def write_normals(traced: TracedImage, image: NDArray[np.float32]) -> None:
    """Write (H, W, 3) unit normals; zeros where a ray hits nothing, or starts in the ground or a solid."""
    for row in range(image.shape[0]):
        _write_row(traced, traced.workspace.blocks, nonnegative(row * image.shape[1]), image[row])


@inlined_kernel
def _write_row(traced: TracedImage, blocks: Blocks, start: int, line: NDArray[np.float32]) -> None:
    """Write (W, 3) the normals of a row of pixels, the first of whose rays is ``start``."""
    statics, width, buffer = traced.solids.obbs.shape[0], line.shape[0], traced.buffer
    first = 0
    while first < width:
        met, last = buffer.met[start + first], first + 1
        while last < width and buffer.met[start + last] == met:
            last += 1
        part = line[first:last]
        if met < NOTHING:
            _fill(part, _normal_of_ground(blocks, index_in_code(met)))
        elif met == NOTHING:
            _fill(part, (0.0, 0.0, 0.0))
        elif met < statics:
            _write_solid(traced.solids, met, traced.camera, buffer, start + first, part)
        else:
            _write_solid(traced.moving, met - statics, traced.camera, buffer, start + first, part)
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
def _normal_of_ground(blocks: Blocks, triangle: int) -> tuple[float, float, float]:
    """Return the unit normal of a triangle of the terrain, numbered as in ``Hits``."""
    cell, half = triangle // 2, triangle % 2
    columns = blocks.extent[COLUMNS]
    row, column = cell // columns, cell % columns
    block = (row // BLOCK) * (-(-columns // BLOCK)) + column // BLOCK
    corner = (row % BLOCK) * CORNERS + column % BLOCK
    heights = blocks.heights[block]
    h00, h01 = heights[corner], heights[corner + 1]
    h10, h11 = heights[corner + CORNERS], heights[corner + CORNERS + 1]
    south_east = half == 0
    east = (h01 - h00 if south_east else h11 - h10) / CELL
    north = (h11 - h01 if south_east else h10 - h00) / CELL
    length = np.sqrt(east * east + 1.0 + north * north)
    return -east / length, 1.0 / length, -north / length
