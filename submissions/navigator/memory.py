"""What the navigator remembers: checkpoints on its way, and where obstacles were, on each of four storeys."""

import math

from wildscav.geometry import flat_distance

Vector = tuple[float, float, float]

EVERY = 8  # steps between checkpoints
APART = 3.0  # m between them, at least
KEPT = 40  # checkpoints
STOREY = 3.0  # m
STOREYS = 4


class Memory:
    """Checkpoints, and a matrix of cells of 1 m on four storeys in which obstacles are marked."""

    def __init__(self, start: Vector) -> None:
        self.checkpoints: list[Vector] = [start]
        self.steps = 0
        self.marks: dict[tuple[int, int, int], int] = {}  # times that the agent was held up, or passed

    def note(self, position: Vector) -> None:
        """Store a checkpoint every few steps."""
        self.steps += 1
        cell = self._cell(position)
        if self.steps % EVERY == 0 and flat_distance(self.checkpoints[-1], position) >= APART:
            self.checkpoints = [*self.checkpoints[-KEPT:], position]
            self.marks[cell] = self.marks.get(cell, 0) + 1

    def mark(self, position: Vector) -> None:
        """Mark an obstacle."""
        cell = self._cell(position)
        self.marks[cell] = self.marks.get(cell, 0) + 4

    def marked(self, position: Vector) -> int:
        """Return how much speaks against going near a place."""
        x, z, storey = self._cell(position)
        return sum(self.marks.get((x + a, z + b, storey), 0) for a in (-1, 0, 1) for b in (-1, 0, 1))

    def way_back(self, position: Vector, count: int) -> list[Vector]:
        """Take back some checkpoints, and return them in the order of the way back; the first one stays."""
        way: list[Vector] = []
        while len(self.checkpoints) > 1 and len(way) < count:
            checkpoint = self.checkpoints.pop()
            if way or flat_distance(checkpoint, position) >= APART / 2.0:
                way.append(checkpoint)
        return way or self.checkpoints[:1]

    @staticmethod
    def _cell(position: Vector) -> tuple[int, int, int]:
        storey = math.floor(position[1] / STOREY) % STOREYS
        return math.floor(position[0]), math.floor(position[2]), storey
