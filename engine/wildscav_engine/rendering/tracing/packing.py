"""What images are made from, as two flat arrays.

Each array that goes from Python to a kernel costs about a third of a microsecond: for all arrays of a scene,
more than a small image takes. So they are laid end to end, and the kernel makes views of them.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import BLOCK
from wildscav_engine.kernel import array_kernel

CORNERS = BLOCK + 1  # of cells, along a side of a block
SQUARE = 96  # corners of a block's cells, 81, and more to make loops over them even
HEAD = 8  # whole numbers that say how many there are of what


class Packed(NamedTuple):
    """Some solids, or a whole scene."""

    numbers: NDArray[np.float64]
    indices: NDArray[np.int64]  # begins with HEAD counts


class Shapes(NamedTuple):
    """S convex solids, F faces in all."""

    boxes: NDArray[np.float64]  # (S, 9) m: of a turned upright box around each, x, y, z of its middle, its
    # radius, half its height, and x and z of its two level half edges
    face_start: NDArray[np.int64]  # (S + 1,) where each solid's faces start
    faces: NDArray[np.float64]  # (F, 4) outward unit normal and its offset in m
    names: NDArray[np.int64]  # (S,) of a scene: the solid's index in the world; of what moves: its owner
    face_names: NDArray[np.int64]  # (S,) index of its first face where its faces come from
    most_faces: int  # of one of them


class Blocks(NamedTuple):
    """A world as B blocks of 8 × 8 cells, row after row, with M members.

    A member is a solid that reaches into a block; it may be one of several.
    """

    heights: NDArray[np.float64]  # (B, 96) m, of the 81 corners of a block's cells, row after row
    water: NDArray[np.float64]  # (B, 64) m, of a block's cells, -inf where dry
    balls: NDArray[np.float64]  # (B, 8) m: x, y, z of a middle, radius: hold the ground and the members;
    # then the lowest and highest ground, the lowest and highest of the members
    edges: NDArray[np.float64]  # (2,) m, x and z of the map's south-western corner
    member_start: NDArray[np.int64]  # (B + 1,) where each block's members start
    members: NDArray[np.int64]  # (M,) solids
    rows: int  # of cells
    columns: int
    overhangs: bool  # whether a solid reaches beyond the map


def pack_shapes(shapes: Shapes) -> Packed:
    """Lay solids end to end."""
    head = np.zeros(HEAD, np.int64)
    head[:3] = len(shapes.boxes), len(shapes.faces), shapes.most_faces
    return Packed(
        np.concatenate([shapes.boxes.ravel(), shapes.faces.ravel()]),
        np.concatenate([head, shapes.face_start, shapes.names, shapes.face_names]),
    )


def pack_scene(blocks: Blocks, shapes: Shapes) -> Packed:
    """Lay the solids of a world and its blocks end to end."""
    solids = pack_shapes(shapes)
    counts = [len(blocks.balls), len(blocks.members), blocks.rows, blocks.columns]
    solids.indices[3], solids.indices[4:8] = blocks.overhangs, counts
    numbers = (blocks.heights, blocks.water, blocks.balls, blocks.edges)
    return Packed(
        np.concatenate([solids.numbers, *(array.ravel() for array in numbers)]),
        np.concatenate([solids.indices, blocks.member_start, blocks.members]),
    )


@array_kernel
def unpack_shapes(packed: Packed) -> Shapes:
    """Return some solids, or those of a scene, as views."""
    numbers, indices = packed.numbers, packed.indices
    solids, faces = indices[0], indices[1]
    boxes = 9 * solids
    starts = HEAD + solids + 1
    return Shapes(
        numbers[:boxes].reshape((solids, 9)),
        indices[HEAD:starts],
        numbers[boxes : boxes + 4 * faces].reshape((faces, 4)),
        indices[starts : starts + solids],
        indices[starts + solids : starts + 2 * solids],
        indices[2],
    )


@array_kernel
def unpack_blocks(packed: Packed) -> Blocks:
    """Return the blocks of a scene as views."""
    solids, faces = packed.indices[0], packed.indices[1]
    blocks, members = packed.indices[4], packed.indices[5]
    numbers, indices = packed.numbers[9 * solids + 4 * faces :], packed.indices[HEAD + 3 * solids + 1 :]
    water = SQUARE * blocks
    balls = water + BLOCK * BLOCK * blocks
    edges = balls + 8 * blocks
    return Blocks(
        numbers[:water].reshape((blocks, SQUARE)),
        numbers[water:balls].reshape((blocks, BLOCK * BLOCK)),
        numbers[balls:edges].reshape((blocks, 8)),
        numbers[edges : edges + 2],
        indices[: blocks + 1],
        indices[blocks + 1 : blocks + 1 + members],
        packed.indices[6],
        packed.indices[7],
        packed.indices[3] != 0,
    )
