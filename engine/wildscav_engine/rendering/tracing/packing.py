"""Scenes packed into flat arrays.

Passing an array from Python to a kernel costs time, and passing a tuple of arrays costs much more: for all
arrays of a scene, more than tracing a small image. So they are concatenated, and the kernel makes views of
the parts.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.geometry.world import BLOCK

CORNERS = BLOCK + 1  # of cells, along a side of a block
SQUARE = 96  # 81 corners of a block's cells, padded so that loops over them vectorize evenly
HEAD = 9  # integers at the start of ``indices``: the sizes of the parts
LANES = 8  # boxes in a group
GROUP = 9 * LANES  # numbers in a group


class Packed(NamedTuple):
    """A whole scene as flat arrays."""

    numbers: NDArray[np.float64]
    indices: NDArray[np.int64]  # begins with HEAD counts
    float32s: NDArray[np.float32]  # only for conservative bounds, where less precision is enough
    kinds: NDArray[np.int8]  # (S,) the Kind of each solid
    blocks: int  # number of blocks
    solids: int
    most_faces: int  # of one of them


class Shapes(NamedTuple):
    """S convex solids with F faces in all."""

    boxes: NDArray[np.float64]  # (S, 9) m: a bounding box, rotated about its vertical axis: x, y, z of its
    # middle, its radius, half its height, and x and z of its two level half edges
    face_start: NDArray[np.int64]  # (S + 1,) where each solid's faces start
    faces: NDArray[np.float64]  # (F, 4) outward unit normal and its offset in m
    names: NDArray[np.int64]  # (S,) in a scene: the solid's index in the world; of a moving solid: its owner
    face_names: NDArray[np.int64]  # (S,) index of its first face in the array that its faces come from


class Blocks(NamedTuple):
    """A world as B blocks of 8 × 8 cells, row after row, with M members in G groups of eight.

    A member of a block is a solid that reaches into it; a solid may be a member of several blocks.
    """

    heights: NDArray[np.float64]  # (B, 96) m, of the 81 corners of a block's cells, row after row
    water: NDArray[np.float64]  # (B, 64) m, of a block's cells, -inf where dry
    spans: NDArray[np.float64]  # (B, 6) m, lowest and highest ground, members, and water; inf, -inf for none
    edges: NDArray[np.float64]  # (2,) m, x and z of the map's south-western corner
    group_start: NDArray[np.int64]  # (B + 1,) where each block's groups start
    members: NDArray[np.int64]  # (G * 8,) solids
    rises: NDArray[np.float32]  # (B, 96) m, heights above the lowest ground of their block
    middles: NDArray[np.float32]  # (B,) m, height of the middle of a block's contents
    radii: NDArray[np.float32]  # (B,) m, radius of a sphere around them
    groups: NDArray[np.float32]  # (G, 72) m: of eight boxes, x, y, z of their middles from the block's
    # south-western corner at its lowest ground, half their heights, x and z of two half edges, their radii
    rows: int  # of cells
    columns: int
    overhangs: bool  # whether a solid reaches beyond the map


def pack_scene(blocks: Blocks, shapes: Shapes, kinds: NDArray[np.int8]) -> Packed:
    """Pack the solids of a world, their kinds and its blocks into flat arrays."""
    head = np.zeros(HEAD, np.int64)
    head[:2] = len(shapes.boxes), len(shapes.faces)
    head[2:7] = len(blocks.spans), len(blocks.groups), blocks.rows, blocks.columns, blocks.overhangs
    numbers = (shapes.boxes, shapes.faces, blocks.heights, blocks.water, blocks.spans, blocks.edges)
    of_shapes = (shapes.face_start, shapes.names, shapes.face_names)
    float32s = (blocks.rises, blocks.middles, blocks.radii, blocks.groups)
    return Packed(
        np.concatenate([array.ravel() for array in numbers]),
        np.concatenate([head, *of_shapes, blocks.group_start, blocks.members]),
        np.concatenate([array.ravel() for array in float32s]),
        kinds,
        len(blocks.spans),
        len(shapes.boxes),
        int(np.diff(shapes.face_start).max(initial=0)),
    )


@inlined_kernel
def unpack_shapes(numbers: NDArray[np.float64], indices: NDArray[np.int64]) -> Shapes:
    """Return the solids in ``Packed`` as views of its arrays."""
    solids, faces = indices[0], indices[1]
    boxes = 9 * solids
    starts = HEAD + solids + 1
    return Shapes(
        numbers[:boxes].reshape((solids, 9)),
        indices[HEAD:starts],
        numbers[boxes : boxes + 4 * faces].reshape((faces, 4)),
        indices[starts : starts + solids],
        indices[starts + solids : starts + 2 * solids],
    )


@inlined_kernel
def unpack_blocks(
    numbers: NDArray[np.float64], indices: NDArray[np.int64], float32s: NDArray[np.float32]
) -> Blocks:
    """Return the blocks of a scene as views of the arrays of ``Packed``."""
    solids, faces, blocks, groups = indices[0], indices[1], indices[2], indices[3]
    water = 9 * solids + 4 * faces + SQUARE * blocks
    spans = water + BLOCK * BLOCK * blocks
    edges = spans + 6 * blocks
    starts = HEAD + 3 * solids + 1
    middles, radii = SQUARE * blocks, (SQUARE + 1) * blocks
    return Blocks(
        numbers[9 * solids + 4 * faces : water].reshape((blocks, SQUARE)),
        numbers[water:spans].reshape((blocks, BLOCK * BLOCK)),
        numbers[spans:edges].reshape((blocks, 6)),
        numbers[edges : edges + 2],
        indices[starts : starts + blocks + 1],
        indices[starts + blocks + 1 : starts + blocks + 1 + LANES * groups],
        float32s[:middles].reshape((blocks, SQUARE)),
        float32s[middles:radii],
        float32s[radii : radii + blocks],
        float32s[radii + blocks : radii + blocks + GROUP * groups].reshape((groups, GROUP)),
        indices[4],
        indices[5],
        indices[6] != 0,
    )
