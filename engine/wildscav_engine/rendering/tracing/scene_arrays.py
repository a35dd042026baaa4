"""The arrays of a scene: its solids, and its world in blocks of cells."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import BLOCK

CORNERS = BLOCK + 1  # of cells, along a side of a block
SQUARE = 96  # 81 corners of a block's cells, padded so that loops over them vectorize evenly
LANES = 8  # boxes in a group
GROUP = 9 * LANES  # numbers in a group
ROWS, COLUMNS, OVERHANGS = range(3)  # of the extent of ``Blocks``


class Shapes(NamedTuple):
    """S convex solids with F faces in all."""

    obbs: NDArray[np.float64]  # (S, 9) m: a bounding box, rotated about its vertical axis: x, y, z of its
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
    lowest: NDArray[np.float64]  # (B,) m, the lowest ground
    layers: NDArray[np.float32]  # (B, 9) m, of boxes around a block's ground, its members and its water: the
    # height of the middle, half the height, and the radius
    edges: NDArray[np.float64]  # (2,) m, x and z of the map's south-western corner
    group_start: NDArray[np.int64]  # (B + 1,) where each block's groups start
    members: NDArray[np.int64]  # (G * 8,) solids
    rises: NDArray[np.float32]  # (B, 96) m, heights above the lowest ground of their block
    middles: NDArray[np.float32]  # (B + 8,) m, height of the middle of a block's contents; then padding
    radii: NDArray[np.float32]  # (B + 8,) m, radius of a sphere around them
    groups: NDArray[np.float32]  # (G, 72) m: of eight boxes, x, y, z of their middles from the block's
    # south-western corner at its lowest ground, half their heights, x and z of two half edges, their radii
    extent: NDArray[np.int64]  # (3,) rows and columns of cells, and 1 if a solid reaches beyond the map
    kinds: NDArray[np.int8]  # (S,) the Kind of each solid


class SceneArrays(NamedTuple):
    """A scene as kernels read it."""

    solids: Shapes
    blocks: Blocks
