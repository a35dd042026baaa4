"""A world prepared for tracing: blocks of cells, the solids in them, and bounding spheres.

It is created on first use and belongs neither to a map's data nor to its digest.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import array_kernel
from wildscav_engine.geometry.world import BLOCK, CELL, World
from wildscav_engine.rendering.tracing.coarse_projection import NEVER_SEEN, ROUNDED, SLACK
from wildscav_engine.rendering.tracing.scene_arrays import (
    CORNERS,
    GROUP,
    LANES,
    SQUARE,
    Blocks,
    SceneArrays,
    Shapes,
)
from wildscav_engine.rendering.tracing.solids import Solids, shapes_of, solids_of_world
from wildscav_engine.rendering.tracing.workspace import LatestOfThread, Size, Workspaces, WorkspaceTable

NO_MEMBER = -1


class Scene(NamedTuple):
    """A world with everything that tracing needs."""

    world: World
    solids: Solids  # of the world, in its order
    arrays: SceneArrays  # for kernels: the same in the order of blocks, for locality
    workspaces: Workspaces  # the workspaces to trace in

    def tables(self, size: Size) -> NDArray[np.int64]:
        """Return (1, F, 6) the table of the workspace for images of a size."""
        return self.workspaces.of(self.arrays, size).tables


class Scenes(LatestOfThread):
    """The scenes that N images show, or one for all, with the tables of their workspaces for each thread."""

    def __init__(self, scenes: Sequence[Scene]) -> None:
        """Collect scenes."""
        super().__init__()
        self.scenes = scenes

    def __reduce__(self) -> tuple[type["Scenes"], tuple[Sequence[Scene]]]:
        """Copy and pickle only the scenes: the copies have other addresses."""
        return Scenes, (self.scenes,)

    def tables(self, size: Size) -> NDArray[np.int64]:
        """Return (N, F, 6) the tables of the workspaces for images of a size."""
        return self.get(size, lambda: self._collect(size))[1]

    def _collect(self, size: Size) -> tuple[list[WorkspaceTable], NDArray[np.int64]]:
        # The tables are addresses, so the workspaces are kept as well.
        workspaces = [scene.workspaces.of(scene.arrays, size) for scene in self.scenes]
        return workspaces, np.concatenate([workspace.tables for workspace in workspaces])


def scene_of(world: World) -> Scene:
    """Prepare a world for tracing."""
    solids = solids_of_world(world)
    start, members = _members_of_blocks(world)
    # In the order of the first block of each solid; solids in no block are never visible.
    _, first = np.unique(members, return_index=True)
    order = members[np.sort(first)]
    place = np.zeros(len(solids.kind), np.int64)
    place[order] = np.arange(len(order))
    spans = _spans_of_blocks(world, solids, start, members)
    shapes = shapes_of(solids, order, order)
    more = ((0, 0), (0, SQUARE - CORNERS * CORNERS))
    heights = np.pad(_in_blocks(world, world.heights, CORNERS), more, mode="edge")
    group_start, grouped = _in_groups(start, place[members])
    middles, radii = (np.pad(part, (0, LANES)) for part in _bounding_spheres(spans))
    blocks = Blocks(
        heights,
        _in_blocks(world, world.water, BLOCK),
        spans[:, 0].copy(),
        _layers_of(spans),
        world.corner,
        group_start,
        np.maximum(grouped, 0),
        (heights - spans[:, :1]).astype(np.float32),
        middles,
        radii,
        _groups_of(world, shapes, spans[:, 0], group_start, grouped),
        np.array([*world.water.shape, _overhangs(world)]),
        world.solid_kind[order],
    )
    return Scene(world, solids, SceneArrays(shapes, blocks), Workspaces())


def _overhangs(world: World) -> bool:
    """Return whether a solid reaches beyond the map."""
    size = CELL * np.array(world.water.shape[::-1])
    low, high = world.solid_low[:, ::2] - world.corner, world.solid_high[:, ::2] - world.corner
    return bool((low < 0.0).any() or (high > size).any())


def _in_blocks(world: World, values: NDArray[np.float64], side: int) -> NDArray[np.float64]:
    """Return (B, side * side) values of each block; beyond the map, the outermost values are repeated."""
    block_rows, block_columns = world.block_top.shape
    within = np.arange(side)
    rows = np.minimum(BLOCK * np.arange(block_rows)[:, None] + within, values.shape[0] - 1)
    columns = np.minimum(BLOCK * np.arange(block_columns)[:, None] + within, values.shape[1] - 1)
    picked = values[rows[:, None, :, None], columns[None, :, None, :]]
    return np.ascontiguousarray(picked.reshape(block_rows * block_columns, side * side))


def _bounding_spheres(spans: NDArray[np.float64]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the heights of the blocks' middles and the radii of their bounding spheres, (B,) m each."""
    low, high = np.minimum(spans[:, 0], spans[:, 2]), spans[:, 1::2].max(axis=1)
    radius = np.sqrt(0.5 * (BLOCK * CELL) ** 2 + 0.25 * (high - low) ** 2)
    return (0.5 * (low + high)).astype(np.float32), _rounded_up(radius)


def _layers_of(spans: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return (B, 9) the boxes around the layers of blocks; see ``Blocks``."""
    low, high = spans[:, 0::2], spans[:, 1::2]
    has_any = low <= high
    low, high = np.where(has_any, low, 0.0), np.where(has_any, high, 0.0)
    half = 0.5 * (high - low)
    radii = np.where(has_any, _rounded_up(np.sqrt(0.5 * (BLOCK * CELL) ** 2 + half**2)), NEVER_SEEN)
    return np.stack([0.5 * (low + high), half, radii], axis=2).reshape(len(spans), 9).astype(np.float32)


def _rounded_up(radii: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return radii in m enlarged to allow for rounding."""
    return (radii * (1.0 + ROUNDED) + SLACK).astype(np.float32)


def _in_groups(
    start: NDArray[np.int64], members: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return where each block's groups start, and the members in groups of eight, padded with -1."""
    counts = np.diff(start)
    group_start = np.concatenate([np.zeros(1, np.int64), np.cumsum(-(-counts // LANES))])
    grouped = np.full(LANES * group_start[-1], NO_MEMBER)
    shift = np.repeat(LANES * group_start[:-1] - start[:-1], counts)
    grouped[np.arange(len(members)) + shift] = members
    return group_start, grouped


def _groups_of(
    world: World,
    shapes: Shapes,
    ground: NDArray[np.float64],
    group_start: NDArray[np.int64],
    grouped: NDArray[np.int64],
) -> NDArray[np.float32]:
    """Return (G, 72) groups; see ``Blocks``. ``ground`` is the lowest ground of each block, (B,) m."""
    columns = world.block_top.shape[1]
    boxes = np.zeros((len(grouped), 9))
    is_one = grouped != NO_MEMBER
    boxes[is_one] = shapes.obbs[grouped[is_one]]
    block = np.repeat(np.arange(len(group_start) - 1), LANES * np.diff(group_start))
    boxes[:, 0] -= world.corner[0] + BLOCK * CELL * (block % columns)
    boxes[:, 1] -= ground[block]
    boxes[:, 2] -= world.corner[1] + BLOCK * CELL * (block // columns)
    radii = np.where(is_one, _rounded_up(boxes[:, 3]), NEVER_SEEN)
    ordered = np.concatenate([boxes[:, [0, 1, 2, 4, 5, 6, 7, 8]], radii[:, None]], axis=1)
    return ordered.reshape(-1, LANES, 9).transpose(0, 2, 1).reshape(-1, GROUP).astype(np.float32)


@array_kernel
def _members_of_blocks(world: World) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return where each block's members start, and the members, each once per block."""
    rows, columns = world.water.shape
    block_rows, block_columns = world.block_top.shape
    start = np.zeros(block_rows * block_columns + 1, np.int64)
    members = np.empty(world.cell_solids.shape[0], np.int64)
    last_block = np.full(world.solid_kind.shape[0], -1, np.int64)
    count = 0
    for block in range(block_rows * block_columns):
        first_row, first_column = block // block_columns * BLOCK, block % block_columns * BLOCK
        for row in range(first_row, min(rows, first_row + BLOCK)):
            for column in range(first_column, min(columns, first_column + BLOCK)):
                cell = row * columns + column
                for item in range(world.cell_start[cell], world.cell_start[cell + 1]):
                    solid = world.cell_solids[item]
                    if last_block[solid] != block:
                        last_block[solid] = block
                        members[count] = solid
                        count += 1
        start[block + 1] = count
    return start, members[:count].copy()


def _spans_of_blocks(
    world: World, solids: Solids, start: NDArray[np.int64], members: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return (B, 6) m: lowest and highest ground, members and water of each block; inf, -inf for none."""
    ground = _in_blocks(world, world.heights, CORNERS)
    block = np.repeat(np.arange(len(ground)), np.diff(start))
    low, high = np.full(len(ground), np.inf), np.full(len(ground), -np.inf)
    np.minimum.at(low, block, solids.low[members, 1])
    np.maximum.at(high, block, solids.high[members, 1])
    water = _in_blocks(world, world.water, BLOCK)  # -inf where it is dry
    lowest_water = np.where(water > -np.inf, water, np.inf).min(axis=1)
    spans = ground.min(axis=1), ground.max(axis=1), low, high, lowest_water, water.max(axis=1)
    return np.stack(spans, axis=1)
