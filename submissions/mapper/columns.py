"""The map that the agent makes: columns of small boxes, each of which something was seen in.

The ground is divided into cells. The column above a cell is a whole number, whose bits are boxes of 0.25 m:
1 where the camera saw a surface. From them follows where a body can stand, and what it would hit. Where
nothing was seen, a column is supposed to be free.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav import MatchInfo
from wildscav.geometry import EYE_HEIGHT, flat_distance

Vector = tuple[float, float, float]

CELL = 0.5  # m
SHIFT = 0.1  # m away from each cell beside that is closed
BOX = 0.25  # m, height of a box
LOWEST = 60.0  # m below the start, where columns begin
HIGHEST = 1000  # boxes, where they end
BODY = 7  # boxes that a standing body needs above its floor
STEP = 3  # boxes up that can be walked, from a cell to the next
JUMP = 5  # boxes up that can be jumped
REACH = 16  # boxes, by which known ground may lie above ground that was not seen
STEEPEST = math.cos(math.radians(45.0))  # least upward part of the normal of a surface to stand on
SOLID = (1 << (HIGHEST + 2 * BODY)) - 1


class Entered(NamedTuple):
    """What a body finds in a cell that it goes to."""

    height: int  # boxes, of its floor
    is_known: bool  # whether the floor was seen


class Columns:
    """The columns of a map as far as they were seen."""

    def __init__(self, match: MatchInfo) -> None:
        self.half = match.map_size / 2.0
        self.side = math.ceil(match.map_size / CELL) + 2  # cells, with a border that nobody enters
        self.bottom = match.start[1] - LOWEST
        self.boxes: dict[int, int] = dict.fromkeys(self._border(), SOLID)  # by cell
        self.flat: dict[int, int] = {}  # by cell, the boxes in which something not too steep was seen
        self.floors: dict[int, int] = {}  # by cell, the boxes on which a body can stand; computed on demand
        self.walked: dict[int, int] = {}  # by cell, the box that the agent itself stood in
        self.bumps: set[int] = set()  # cells that could not be entered, though nothing was seen there

    def _border(self) -> list[int]:
        side = self.side
        rows = [*range(side), *range(side * (side - 1), side * side)]
        return rows + [row * side + edge for row in range(side) for edge in (0, side - 1)]

    def cell(self, x: float, z: float) -> int:
        """Return the cell of a place."""
        column = int((x + self.half) / CELL) + 1
        row = int((z + self.half) / CELL) + 1
        last = self.side - 1
        return min(max(row, 0), last) * self.side + min(max(column, 0), last)

    def place(self, cell: int) -> tuple[float, float]:
        """Return x and z of the middle of a cell, m."""
        row, column = divmod(cell, self.side)
        return (column - 0.5) * CELL - self.half, (row - 0.5) * CELL - self.half

    def roomy_place(self, cell: int, height: int) -> tuple[float, float]:
        """Return x and z in a cell, m, away from what a body on a floor there would touch beside it."""
        x, z = self.place(cell)
        east = north = 0.0
        for row in (-1, 0, 1):
            for column in (-1, 0, 1):
                if self.enter(cell + row * self.side + column, height, was_known=True) is None:
                    east, north = east - column * SHIFT, north - row * SHIFT
        return x + min(max(east, -CELL / 2.0), CELL / 2.0), z + min(max(north, -CELL / 2.0), CELL / 2.0)

    def level(self, y: float) -> int:
        """Return the box that a height in m is in."""
        return min(max(int((y - self.bottom) / BOX), 1), HIGHEST - 1)

    def walk(self, before: Vector, position: Vector) -> None:
        """Note that the agent walked from a place to another, m."""
        count = 1 + int(2.0 * flat_distance(before, position) / CELL)
        for number in range(count + 1):
            x, y, z = (a + (b - a) * number / count for a, b in zip(before, position, strict=True))
            cell = self.cell(x, z)
            self.walked[cell] = self.level(y)
            self.bumps.discard(cell)

    def forget(self, position: Vector, reach: float) -> None:
        """Forget everything within some m of a place."""
        cells = math.ceil(reach / CELL)
        middle = self.cell(position[0], position[2])
        for row in range(-cells, cells + 1):
            for column in range(-cells, cells + 1):
                cell = middle + row * self.side + column
                if self.boxes.get(cell) != SOLID:
                    for known in (self.boxes, self.flat, self.floors):
                        known.pop(cell, None)
                    self.bumps.discard(cell)

    def bump(self, x: float, z: float, *, although_walked: bool) -> None:
        """Note that there is no way into a cell, unless the agent was there and that is to count."""
        cell = self.cell(x, z)
        if although_walked:
            self.walked.pop(cell, None)
        if cell not in self.walked:
            self.bumps.add(cell)

    def see(self, points: NDArray[np.float64], is_flat: NDArray[np.bool_]) -> None:
        """Note that there are surfaces.

        Args:
            points: (N, 3) m.
            is_flat: (N,) whether a body can stand on each.
        """
        places = np.floor((points[:, ::2] + self.half) / CELL).astype(np.int64) + 1
        levels = np.floor((points[:, 1] - self.bottom) / BOX).astype(np.int64)
        inside = (places > 0).all(axis=1) & (places < self.side - 1).all(axis=1)
        inside &= (levels > 0) & (levels < HIGHEST)
        cells = places[inside, 1] * self.side + places[inside, 0]
        keys = cells * HIGHEST + levels[inside]
        self._add(self.boxes, keys)
        self._add(self.flat, keys[is_flat[inside]])

    def _add(self, boxes: dict[int, int], keys: NDArray[np.int64]) -> None:
        for key in np.unique(keys).tolist():
            cell, level = divmod(key, HIGHEST)
            before = boxes.get(cell, 0)
            after = before | 1 << level
            if after != before:
                boxes[cell] = after
                self.floors.pop(cell, None)

    def enter(self, cell: int, height: int, was_known: bool) -> Entered | None:
        """Return what a body finds in a cell that it goes to, or None if it cannot go there.

        Args:
            cell: The cell.
            height: Of the floor that it comes from, boxes.
            was_known: Whether that floor was seen.
        """
        stood = self.walked.get(cell)
        if stood is not None and abs(stood - height) <= JUMP:
            return Entered(stood, True)
        if cell in self.bumps:
            return None
        boxes = self.boxes.get(cell)
        if boxes is None:
            return Entered(height, False)
        floors = self.floors.get(cell)
        if floors is None:
            floors = self.floors[cell] = self.flat.get(cell, 0) & ~_below(boxes)
        below = floors & ((1 << (height + (JUMP if was_known else REACH) + 1)) - 1)
        if not below:  # its floor was not seen
            return None if boxes >> (height + STEP) & 0b11111 else Entered(height, False)
        floor = below.bit_length() - 1
        room = max(height, floor) + BODY - floor
        if boxes >> (floor + 1) & ((1 << room) - 1):
            return None
        return Entered(floor, True)


def _below(boxes: int) -> int:
    """Return the boxes that are less than a body's height below others."""
    below = boxes >> 1
    below |= below >> 1
    below |= below >> 2
    return below | below >> 3


class DepthCamera:
    """Turns depth maps into points."""

    def __init__(self, field_of_view: float, far: float) -> None:
        self.slope = math.tan(math.radians(field_of_view / 2.0))
        self.far = far

    def points(
        self, depth: NDArray[np.float32], position: Vector, yaw: float, pitch: float
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """Return (N, 3) m, the surfaces in a depth map, and (N,) whether a body can stand on each.

        Args:
            depth: (height, width) m, along the view axis.
            position: Of the soles, m.
            yaw: Degrees.
            pitch: Degrees, positive looks down.
        """
        height, width = depth.shape
        right = (np.arange(width) + 0.5 - width / 2.0) * (2.0 * self.slope / width)
        up = (height / 2.0 - 0.5 - np.arange(height)) * (2.0 * self.slope / width)
        ahead = depth.astype(np.float64)
        aside, above = ahead * right, ahead * up[:, None]
        down, turn = math.radians(pitch), math.radians(yaw)
        level = ahead * math.cos(down) + above * math.sin(down)
        x = position[0] + level * math.sin(turn) + aside * math.cos(turn)
        y = position[1] + EYE_HEIGHT + above * math.cos(down) - ahead * math.sin(down)
        z = position[2] + level * math.cos(turn) - aside * math.sin(turn)
        places = np.stack([x, y, z], axis=-1)
        reach = ahead * np.sqrt(1.0 + right**2 + up[:, None] ** 2)
        seen = (reach < self.far * 0.99)[:-1, :-1]
        return places[:-1, :-1][seen], is_flat(places)[seen]


def is_flat(places: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return (height - 1, width - 1) whether the surface between a pixel and its neighbours is not too steep.

    Args:
        places: (height, width, 3) m, what each pixel shows.
    """
    across, downward = places[:-1, 1:] - places[:-1, :-1], places[1:, :-1] - places[:-1, :-1]
    normal = np.cross(across, downward)
    return np.abs(normal[..., 1]) >= STEEPEST * np.linalg.norm(normal, axis=-1)
