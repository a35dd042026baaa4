"""A map of the surfaces that an agent has seen with its LIDAR: columns of voxels, storey above storey."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav.agent import Vector
from wildscav.geometry import EYE_HEIGHT

CELL = 0.3  # m, side of a column
VOXEL = 0.25  # m, height of a voxel
COLUMN_BITS = 64  # voxels in a column: 16 m
BELOW = 26  # voxels of a column below the soles of the agent that saw it first


class Rings(NamedTuple):
    """The options of the LIDAR, as in the submission's manifest."""

    range: float  # m
    lowest: float  # degrees above the horizon, of the lowest ring
    highest: float  # degrees above the horizon, of the highest ring


class Window(NamedTuple):
    """The voxels of a rectangle of columns; all columns begin at the same height."""

    west: int  # column of the map
    south: int
    width: int  # columns from west to east
    bottom: int  # voxel at which the columns begin
    own: list[int]  # by column, west to east and then south to north: bits of the voxels with a surface
    beside: list[int]  # the same, with the surfaces of the four columns beside it added
    around: list[int]  # the same, with those of all eight columns around it

    def index_of(self, place: Vector, half: float) -> int:
        """Return the index of the column of a place; ``half`` is half of the map's side, m."""
        east = min(max(int((place[0] + half) / CELL) - self.west, 1), self.width - 2)
        height = len(self.own) // self.width
        north = min(max(int((place[2] + half) / CELL) - self.south, 1), height - 2)
        return north * self.width + east

    def voxel_of(self, height: float) -> int:
        """Return the voxel at a height (m), kept away from the ends of the columns."""
        return min(max(math.floor((height + 0.02) / VOXEL) - self.bottom, 2), 54)

    def is_edge(self, index: int) -> bool:
        """Return whether a column is at the edge of the rectangle."""
        north, east = divmod(index, self.width)
        return not (0 < east < self.width - 1 and 0 < north < len(self.own) // self.width - 1)

    def place_of(self, index: int, voxel: int, half: float) -> Vector:
        """Return the middle of a column at the height of a voxel, m."""
        north, east = divmod(index, self.width)
        return (
            (self.west + east + 0.5) * CELL - half,
            (self.bottom + voxel + 0.5) * VOXEL,
            (self.south + north + 0.5) * CELL - half,
        )


class Surroundings:
    """What an agent has seen of the world, as one 64-bit column of voxels for each cell of a grid."""

    def __init__(self, map_size: float, rings: Rings) -> None:
        """Begin with an empty map of so many metres a side, for readings of a LIDAR with these rings."""
        self.half = map_size / 2.0
        self.rings = rings
        self.count = math.ceil(map_size / CELL) + 1
        self.voxels = np.zeros(self.count * self.count, np.uint64)
        self.bottoms = np.zeros(self.count * self.count, np.int16)  # voxel at which each column begins
        self._rays = np.zeros((0, 0, 3))

    def see(self, place: Vector, yaw: float, reading: NDArray[np.float32]) -> NDArray[np.float64]:
        """Add a LIDAR's reading, (channels, azimuths) m, and return the points that it hit, (N, 3) m.

        The agent's soles are at ``place``; its yaw is in degrees.
        """
        hit = reading < self.rings.range * 0.999
        rays = self._directions(reading.shape)[hit] * reading[hit].astype(np.float64)[:, None]
        turn = math.radians(yaw)
        points = np.empty_like(rays)
        points[:, 0] = place[0] + rays[:, 0] * math.cos(turn) + rays[:, 2] * math.sin(turn)
        points[:, 1] = place[1] + EYE_HEIGHT + rays[:, 1]
        points[:, 2] = place[2] - rays[:, 0] * math.sin(turn) + rays[:, 2] * math.cos(turn)
        self._mark(points, place[1])
        return points

    def stand(self, place: Vector) -> None:
        """Note that there is ground under an agent's soles."""
        self._mark(np.array([[place[0], place[1] - 0.02, place[2]]]), place[1])

    def block(self, place: Vector) -> None:
        """Put an obstacle that the LIDAR does not show at a place, from the soles up to the head."""
        heights = np.arange(0.6, 1.8, VOXEL)
        self._mark(np.array([[place[0], place[1] + height, place[2]] for height in heights]), place[1])

    def is_roofed(self, place: Vector) -> bool:
        """Return whether something is above an agent's head at a place, within 6 m."""
        cell = self._cell(place[0]) + self.count * self._cell(place[2])
        first = math.floor((place[1] + 2.0) / VOXEL) - int(self.bottoms[cell])
        return first >= 0 and (int(self.voxels[cell]) >> first) & 0xFFFFFF != 0

    def window(self, place: Vector, reach: float) -> Window:
        """Return the columns around a place, up to ``reach`` metres away, without the edges of the map."""
        east, north, cells = self._cell(place[0]), self._cell(place[2]), int(reach / CELL)
        west, south = max(east - cells, 0), max(north - cells, 0)
        stop_x, stop_z = min(east + cells + 1, self.count), min(north + cells + 1, self.count)
        bottom = math.floor(place[1] / VOXEL) - BELOW
        square, part = (self.count, self.count), (slice(south, stop_z), slice(west, stop_x))
        grid = self.voxels.reshape(square)[part]
        lift = self.bottoms.reshape(square)[part].astype(np.int64) - bottom
        up, down = np.clip(lift, 0, 63).astype(np.uint64), np.clip(-lift, 0, 63).astype(np.uint64)
        own = np.where(np.abs(lift) > 63, np.uint64(0), (grid << up) >> down)
        beside = own.copy()
        for axis, shift in ((0, 1), (0, -1), (1, 1), (1, -1)):
            beside |= np.roll(own, shift, axis)
        around = beside.copy()
        for shift in (1, -1):
            around |= np.roll(np.roll(own, shift, 0), 1, 1) | np.roll(np.roll(own, shift, 0), -1, 1)
        lists = (columns.ravel().tolist() for columns in (own, beside, around))
        return Window(west, south, own.shape[1], bottom, *lists)

    def is_free(self, place: Vector) -> bool:
        """Return whether nothing that was seen is in the way of the body of an agent at a place."""
        cell = self._cell(place[0]) + self.count * self._cell(place[2])
        knees = math.floor((place[1] + 0.6) / VOXEL) - int(self.bottoms[cell])
        return knees < 0 or (int(self.voxels[cell]) >> knees) & 0b1111 == 0

    def is_solid(self, point: Vector) -> bool:
        """Return whether a surface was seen in the voxel of a point."""
        cell = self._cell(point[0]) + self.count * self._cell(point[2])
        bit = math.floor(point[1] / VOXEL) - int(self.bottoms[cell])
        return 0 <= bit < COLUMN_BITS and bool(int(self.voxels[cell]) >> bit & 1)

    def _cell(self, coordinate: float) -> int:
        return min(max(int((coordinate + self.half) / CELL), 0), self.count - 1)

    def _mark(self, points: NDArray[np.float64], soles: float) -> None:
        """Note that there are surfaces at points (N, 3) m, seen by an agent whose soles are at a height."""
        columns = ((points[:, [0, 2]] + self.half) / CELL).astype(np.int64).clip(0, self.count - 1)
        cells = columns[:, 0] + self.count * columns[:, 1]
        fresh = cells[self.voxels[cells] == 0]
        self.bottoms[fresh] = math.floor(soles / VOXEL) - BELOW
        bits = np.floor(points[:, 1] / VOXEL).astype(np.int64) - self.bottoms[cells]
        inside = (bits >= 0) & (bits < COLUMN_BITS)
        np.bitwise_or.at(self.voxels, cells[inside], np.uint64(1) << bits[inside].astype(np.uint64))

    def _directions(self, shape: tuple[int, ...]) -> NDArray[np.float64]:
        """Return the unit vectors of the rays, (channels, azimuths, 3), for an agent that looks north."""
        if self._rays.shape[:2] != shape:
            up = np.radians(np.linspace(self.rings.highest, self.rings.lowest, shape[0]))[:, None]
            side = np.radians(np.arange(shape[1]) * 360.0 / shape[1])[None]
            east, north = np.cos(up) * np.sin(side), np.cos(up) * np.cos(side)
            self._rays = np.stack([east, np.broadcast_to(np.sin(up), shape), north], axis=-1)
        return self._rays
