"""What images are made from, as three flat arrays.

Each array that goes from Python to a kernel costs time, and a tuple of them much more: for all arrays of a
scene, more than a small image takes. So they are laid end to end, and the kernel makes views of them.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.geometry.world import BLOCK

CORNERS = BLOCK + 1  # of cells, along a side of a block
SQUARE = 96  # corners of a block's cells, 81, and more to make loops over them even
HEAD = 9  # whole numbers that say how many there are of what
LANES = 8  # boxes of a group
GROUP = 9 * LANES  # numbers of a group


class Packed(NamedTuple):
    """Some solids, or a whole scene."""

    numbers: NDArray[np.float64]
    indices: NDArray[np.int64]  # begins with HEAD counts
    halves: NDArray[np.float32]  # half as precise, for what only says where to look
    blocks: int  # how many
    solids: int
    most_faces: int  # of one of them


class Shapes(NamedTuple):
    """S convex solids, F faces in all."""

    boxes: NDArray[np.float64]  # (S, 9) m: of a turned upright box around each, x, y, z of its middle, its
    # radius, half its height, and x and z of its two level half edges
    face_start: NDArray[np.int64]  # (S + 1,) where each solid's faces start
    faces: NDArray[np.float64]  # (F, 4) outward unit normal and its offset in m
    names: NDArray[np.int64]  # (S,) of a scene: the solid's index in the world; of what moves: its owner
    face_names: NDArray[np.int64]  # (S,) index of its first face where its faces come from


class Blocks(NamedTuple):
    """A world as B blocks of 8 × 8 cells, row after row, whose M members stand in G groups of eight.

    A member is a solid that reaches into a block; it may be one of several.
    """

    heights: NDArray[np.float64]  # (B, 96) m, of the 81 corners of a block's cells, row after row
    water: NDArray[np.float64]  # (B, 64) m, of a block's cells, -inf where dry
    spans: NDArray[np.float64]  # (B, 4) m, lowest and highest ground, lowest and highest of the members
    edges: NDArray[np.float64]  # (2,) m, x and z of the map's south-western corner
    group_start: NDArray[np.int64]  # (B + 1,) where each block's groups start
    members: NDArray[np.int64]  # (G * 8,) solids
    rises: NDArray[np.float32]  # (B, 96) m, heights above the lowest ground of their block
    middles: NDArray[np.float32]  # (B,) m, height of the middle of all that is in a block
    radii: NDArray[np.float32]  # (B,) m, of a ball around that
    groups: NDArray[np.float32]  # (G, 72) m: of eight boxes, x, y, z of their middles from the block's
    # south-western corner at its lowest ground, half their heights, x and z of two half edges, their radii
    rows: int  # of cells
    columns: int
    overhangs: bool  # whether a solid reaches beyond the map


def pack_shapes(shapes: Shapes) -> Packed:
    """Lay solids end to end."""
    head = np.zeros(HEAD, np.int64)
    head[:2] = len(shapes.boxes), len(shapes.faces)
    most_faces = int(np.diff(shapes.face_start).max(initial=0))
    return Packed(
        np.concatenate([shapes.boxes.ravel(), shapes.faces.ravel()]),
        np.concatenate([head, shapes.face_start, shapes.names, shapes.face_names]),
        np.zeros(0, np.float32),
        0,
        len(shapes.boxes),
        most_faces,
    )


def pack_scene(blocks: Blocks, shapes: Shapes) -> Packed:
    """Lay the solids of a world and its blocks end to end."""
    solids = pack_shapes(shapes)
    count = len(blocks.spans)
    solids.indices[2:7] = count, len(blocks.groups), blocks.rows, blocks.columns, blocks.overhangs
    numbers = (blocks.heights, blocks.water, blocks.spans, blocks.edges)
    halves = (blocks.rises, blocks.middles, blocks.radii, blocks.groups)
    return solids._replace(
        numbers=np.concatenate([solids.numbers, *(array.ravel() for array in numbers)]),
        indices=np.concatenate([solids.indices, blocks.group_start, blocks.members]),
        halves=np.concatenate([array.ravel() for array in halves]),
        blocks=count,
    )


def pack_nothing() -> Packed:
    """Return no solids."""
    none = np.zeros(0, np.int64)
    return pack_shapes(Shapes(np.zeros((0, 9)), np.zeros(1, np.int64), np.zeros((0, 4)), none, none))


@inlined_kernel
def unpack_shapes(numbers: NDArray[np.float64], indices: NDArray[np.int64]) -> Shapes:
    """Return some solids, or those of a scene, as views of what ``Packed`` holds."""
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
    numbers: NDArray[np.float64], indices: NDArray[np.int64], halves: NDArray[np.float32]
) -> Blocks:
    """Return the blocks of a scene as views of what ``Packed`` holds."""
    solids, faces, blocks, groups = indices[0], indices[1], indices[2], indices[3]
    water = 9 * solids + 4 * faces + SQUARE * blocks
    spans = water + BLOCK * BLOCK * blocks
    edges = spans + 4 * blocks
    starts = HEAD + 3 * solids + 1
    middles, radii = SQUARE * blocks, (SQUARE + 1) * blocks
    return Blocks(
        numbers[9 * solids + 4 * faces : water].reshape((blocks, SQUARE)),
        numbers[water:spans].reshape((blocks, BLOCK * BLOCK)),
        numbers[spans:edges].reshape((blocks, 4)),
        numbers[edges : edges + 2],
        indices[starts : starts + blocks + 1],
        indices[starts + blocks + 1 : starts + blocks + 1 + LANES * groups],
        halves[:middles].reshape((blocks, SQUARE)),
        halves[middles:radii],
        halves[radii : radii + blocks],
        halves[radii + blocks : radii + blocks + GROUP * groups].reshape((groups, GROUP)),
        indices[4],
        indices[5],
        indices[6] != 0,
    )
