"""Searching a map for a hidden target together with the teammates."""

import math
from itertools import product

from wildscav.agent import MatchInfo, Observation, Vector
from wildscav.geometry import flat_distance

Cell = tuple[int, int]  # column and row

CELL = 10.0  # m
SIGHT = 15.0  # m; a target is found within 20 m, but it may be in a corner of its cell, or on a hill


class Scouting:
    """The cells of a grid over the map whose centers no teammate has been near."""

    def __init__(self, match: MatchInfo) -> None:
        self.half = match.map_size / 2.0  # m
        self.count = math.ceil(match.map_size / CELL)  # in a row
        self.unseen = self._all_cells()
        self.cell: Cell | None = None  # where the agent is going
        self.patience = 0  # steps left to get there

    def next_place(self, observation: Observation) -> Vector:
        """Return where to walk while the target is not known."""
        here, mates = observation.position, teammates(observation)
        for position in (here, *mates):
            self._see(position)
        self.patience -= 1
        if self.patience < 0 and self.cell is not None:
            self.unseen.discard(self.cell)  # it seems to be out of reach
        if self.cell not in self.unseen:
            self.unseen = self.unseen or self._all_cells()
            self.cell = min(self.unseen, key=lambda cell: self._cost(self._center(cell, here), here, mates))
            self.patience = 20 + round(flat_distance(here, self._center(self.cell, here)) * 2.0)
        return self._center(self.cell, here)

    def _all_cells(self) -> set[Cell]:
        return set(product(range(self.count), range(self.count)))

    def _see(self, position: Vector) -> None:
        """Note that a teammate is at a position."""
        column, row = (int((position[axis] + self.half) // CELL) for axis in (0, 2))
        for cell in product(range(column - 2, column + 3), range(row - 2, row + 3)):
            if flat_distance(position, self._center(cell, position)) < SIGHT:
                self.unseen.discard(cell)

    def _center(self, cell: Cell, here: Vector) -> Vector:
        column, row = cell
        return ((column + 0.5) * CELL - self.half, here[1], (row + 0.5) * CELL - self.half)

    @staticmethod
    def _cost(place: Vector, here: Vector, mates: list[Vector]) -> tuple[bool, float, Vector]:
        """Return a sort key: first the places that no teammate is nearer to, by distance."""
        own = flat_distance(here, place)
        return any(flat_distance(mate, place) < own for mate in mates), own, place


def teammates(observation: Observation) -> list[Vector]:
    """Return the positions of the teammates, m. The submission must ask for the sensor ``teammates``."""
    x, y, z = observation.position
    return [
        (x + float(row[2]), y + float(row[3]), z + float(row[4]))
        for row in observation.sensor("teammates")
        if row[0]
    ]
