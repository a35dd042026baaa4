"""A triangle mesh just above the ground, of which parts are shown in colour: heat map, safe zone."""

from functools import cached_property

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from wildscav_engine.geometry.world import CELL, World
from wildscav_engine.view.recording import coordinates
from wildscav_engine.view.recording.columns import Columns

MAX_CELLS = 80  # along each side; on larger maps, the overlay is coarser than the ground
LIFT = 0.3  # m above the ground or the water


class GroundOverlay:
    """The overlay of one map: N × N vertices, numbered row by row northwards."""

    def __init__(self, world: World, max_cells: int = MAX_CELLS) -> None:
        """Create the overlay of a world.

        Args:
            max_cells: The maximum number of cells along each side.
        """
        across = len(world.heights) - 1
        cells = min(across, max_cells)
        every = np.round(np.linspace(0, across, cells + 1)).astype(np.int64)
        reach = (
            -(-across // cells) - 1
        )  # ground vertices between two of the overlay, which must not rise above it
        height = _highest_around(_surface(world), reach)[np.ix_(every, every)] + LIFT
        self.east = world.corner[0] + CELL * every  # (N,) m
        self.north = world.corner[1] + CELL * every  # (N,) m
        x, z = np.meshgrid(self.east, self.north)
        self.center_east = (self.east[1:] + self.east[:-1]) / 2  # (N - 1,) m, centers of the cells
        self.center_north = (self.north[1:] + self.north[:-1]) / 2
        self.points = np.stack([x, height, z], axis=-1)  # (N, N, 3) m, in the game's coordinates

    @cached_property
    def vertices(self) -> NDArray[np.float32]:
        """The vertices in Rerun's coordinates, (N * N, 3)."""
        return coordinates.points(self.points.reshape(-1, 3))

    @cached_property
    def triangles(self) -> NDArray[np.int32]:
        """All triangles, (2 * (N - 1)², 3), in Rerun's coordinates; the two of a cell are consecutive."""
        count = len(self.east)
        south_west = (count * np.arange(count - 1)[:, None] + np.arange(count - 1)).ravel()
        south_east, north_west, north_east = south_west + 1, south_west + count, south_west + count + 1
        halves = [[south_west, south_east, north_east], [south_west, north_east, north_west]]
        return np.ascontiguousarray(np.array(halves, np.int32).transpose(2, 0, 1).reshape(-1, 3))

    def columns(self, path: str) -> Columns:
        """Return the vertices, from the first row on, for an entity whose triangles change over time.

        They are not static, because the viewer would draw static vertices as triangles where it has none.
        """
        points = rr.Mesh3D.columns(vertex_positions=self.vertices)
        return Columns(path, np.zeros(1, np.int64), points.partition([len(self.vertices)]))

    def triangles_of(self, chosen: NDArray[np.bool_]) -> NDArray[np.int32]:
        """Return the triangles, (M, 3), of some cells; one without area if no cell is chosen.

        The viewer would draw a mesh without triangles as if every three vertices were one.

        Args:
            chosen: (N - 1, N - 1) whether each cell is included.
        """
        if not chosen.any():
            return np.zeros((1, 3), np.int32)
        return np.asarray(self.triangles.reshape(-1, 2, 3)[chosen.ravel()].reshape(-1, 3))


def _surface(world: World) -> NDArray[np.float64]:
    """Return the height of the ground or the water at every vertex of the ground."""
    rows, columns = world.heights.shape
    surface = world.heights.copy()
    for north, east in ((0, 0), (0, 1), (1, 0), (1, 1)):
        part = surface[north : rows - 1 + north, east : columns - 1 + east]
        np.maximum(part, world.water, out=part)
    return surface


def _highest_around(heights: NDArray[np.float64], reach: int) -> NDArray[np.float64]:
    """Return the greatest height within ``reach`` vertices along each axis."""
    if reach == 0:
        return heights
    size = 2 * reach + 1
    padded = np.pad(heights, reach, mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, size, axis=0).max(axis=-1)
    return np.asarray(np.lib.stride_tricks.sliding_window_view(windows, size, axis=1).max(axis=-1))
