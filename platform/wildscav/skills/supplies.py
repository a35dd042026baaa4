"""Remembering supply boxes, and where to look for more."""

import math

import numpy as np
from numpy.typing import NDArray

from wildscav.agent import MatchInfo, Observation, SupplyBox, Vector
from wildscav.geometry import distance, flat_distance
from wildscav.skills.surroundings import Rings

MAX_LISTED = 32  # boxes in an observation
LOST_SHARE = 0.5  # of what it carried, that an agent expects where it died
OWN_LOSS = -1  # the number of the box that it expects there
HOT = 20.0  # m, greatest radius of a wave that is worth a visit
EARLY = 8.0  # s before a wave, at which an agent walks there
CELL = 20.0  # m, of the grid of places to look at
WALL_RISE = 1.2  # m between the hits of two rings on one wall
WALL_DEPTH = 0.6  # m between their distances
WALL_HITS = 4  # of rays, after which a building is expected


class BoxMemory:
    """The task list: every box that was seen and not taken since, as far as the agent can know."""

    def __init__(self, match: MatchInfo) -> None:
        self.sight = match.supply_sight
        self.boxes: dict[int, SupplyBox] = {}
        self.left_alone: dict[int, float] = {}  # s of game time when a box may be tried again, by box
        self.last: Observation | None = None

    def update(self, observation: Observation) -> None:
        """Add the boxes in sight, and what the agent lost where it died; forget those that are gone."""
        self._expect_own_loss(observation)
        if not observation.alive:
            return
        listed = {box.id: box for box in observation.supply_boxes}
        farthest = self.sight - 0.5
        if len(listed) >= MAX_LISTED:
            last = observation.supply_boxes[-1].position
            farthest = min(farthest, distance(observation.position, last) - 0.5)
        for number, box in list(self.boxes.items()):
            if number not in listed and distance(observation.position, box.position) < farthest:
                del self.boxes[number]
        self.boxes.update(listed)

    def _expect_own_loss(self, observation: Observation) -> None:
        if self.last is not None and self.last.alive and not observation.alive:
            quantity = int(self.last.supplies * LOST_SHARE)
            if quantity > 0:
                self.boxes[OWN_LOSS] = SupplyBox(OWN_LOSS, self.last.position, quantity)
        self.last = observation

    def leave_alone(self, number: int, until: float) -> None:
        """Ignore a box until a time, s."""
        self.left_alone[number] = until

    def wanted(self, time: float) -> dict[int, SupplyBox]:
        """Return the boxes that may be fetched at a time, s, by their ids."""
        return {key: box for key, box in self.boxes.items() if self.left_alone.get(key, 0.0) <= time}


class Prospecting:
    """Where to look for boxes: at buildings seen from afar, and at the parts of the map not visited yet."""

    def __init__(self, match: MatchInfo) -> None:
        self.half = match.map_size / 2.0
        self.sight = max(match.supply_sight - 4.0, 8.0)
        self.cell = min(CELL, self.sight)
        self.count = math.ceil(match.map_size / self.cell)
        # Most hits of walls in one reading, by column and row.
        self.walls: NDArray[np.int32] = np.zeros((self.count, self.count), np.int32)
        self.seen: NDArray[np.bool_] = np.zeros((self.count, self.count), bool)
        middles = (np.arange(self.count) + 0.5) * self.cell - self.half
        self.middle_x, self.middle_z = np.meshgrid(middles, middles, indexing="ij")
        self.seen |= np.maximum(np.abs(self.middle_x), np.abs(self.middle_z)) > self.half - 4.0
        self.place: Vector | None = None
        self.give_up_at = 0.0  # s
        self.waves = [wave for wave in match.supply_waves if wave.radius <= HOT]
        self.visited = 0  # of those waves

    def note_walls(self, position: Vector, yaw: float, reading: NDArray[np.float32], rings: Rings) -> None:
        """Note the buildings that a LIDAR sees at a yaw, degrees: many hits of walls, which rise steeply."""
        up = np.radians(np.linspace(rings.highest, rings.lowest, reading.shape[0]))[:, None]
        way, height = reading * np.cos(up), reading * np.sin(up)
        is_wall = (np.abs(np.diff(way, axis=0)) < WALL_DEPTH) & (-np.diff(height, axis=0) > WALL_RISE)
        is_wall &= reading[1:] < rings.range * 0.999
        row, azimuth = np.nonzero(is_wall)
        if len(row) == 0:
            return
        angle = np.radians(yaw + azimuth * 360.0 / reading.shape[1])
        far = way[row, azimuth]
        columns = ((position[0] + far * np.sin(angle) + self.half) / self.cell).astype(np.int64)
        rows = ((position[2] + far * np.cos(angle) + self.half) / self.cell).astype(np.int64)
        hits = np.zeros_like(self.walls)
        np.add.at(hits, (columns.clip(0, self.count - 1), rows.clip(0, self.count - 1)), 1)
        np.maximum(self.walls, hits, out=self.walls)

    def visit(self, position: Vector) -> None:
        """Note that the agent is at a place."""
        self.seen |= np.hypot(self.middle_x - position[0], self.middle_z - position[2]) < self.sight

    def next_place(self, observation: Observation, centre: tuple[float, float]) -> Vector:
        """Return where to go next, when no box is known."""
        here = observation.position
        hot = self._hot_place(observation)
        if hot is not None:
            return hot
        if self.place is not None and observation.time > self.give_up_at:
            self.seen[self._cell(self.place)] = True
        if self.place is None or self.seen[self._cell(self.place)]:
            if self.seen.all():
                self.seen[:] = False
            way = np.hypot(self.middle_x - here[0], self.middle_z - here[2])
            out = np.hypot(self.middle_x - centre[0], self.middle_z - centre[1])
            cost = way + 0.3 * out - 60.0 * (self.walls >= WALL_HITS)
            cost[self.seen] = np.inf
            column, row = divmod(int(np.argmin(cost)), self.count)
            self.place = (float(self.middle_x[column, row]), here[1], float(self.middle_z[column, row]))
            self.give_up_at = observation.time + 4.0 + flat_distance(here, self.place) / 5.0
        return self.place

    def _hot_place(self, observation: Observation) -> Vector | None:
        """Return where supplies have just appeared densely or soon will, if the agent was not there yet."""
        begun = sum(wave.time <= observation.time + EARLY for wave in self.waves)
        if begun <= self.visited:
            return None
        wave = self.waves[begun - 1]
        place = (wave.center[0], observation.position[1], wave.center[1])
        if observation.time >= wave.time and flat_distance(observation.position, place) < wave.radius:
            self.visited = begun
        return place

    def _cell(self, place: Vector) -> tuple[int, int]:
        column, row = (int((place[axis] + self.half) // self.cell) for axis in (0, 2))
        return min(max(column, 0), self.count - 1), min(max(row, 0), self.count - 1)
