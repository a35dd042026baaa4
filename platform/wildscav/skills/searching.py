"""Looking for supplies along a spiral, and choosing the boxes to fetch, without a map."""

import math
from collections.abc import Callable

from wildscav.agent import MatchInfo, Observation, SupplyBox, Vector
from wildscav.geometry import flat_distance


class Search:
    """Places to look for supplies: a spiral around the centre of the last wave."""

    def __init__(self, match: MatchInfo) -> None:
        self.waves = match.supply_waves
        self.spacing = max(match.supply_sight, 5.0)  # m between the spiral's arms
        self.limit = match.map_size / 2.0 - 3.0  # m from the middle of the map
        self.wave = -1
        self.angle = 0.0  # radians along the spiral
        self.patience = 0  # steps left to reach the current place
        self.place: Vector = match.start

    def next_place(self, observation: Observation) -> Vector:
        """Return where to walk when no box is in sight."""
        current = sum(wave.time <= observation.time for wave in self.waves) - 1
        if current != self.wave:
            self.wave, self.angle, self.patience = current, 0.0, 0
        self.patience -= 1
        if self.patience < 0 or flat_distance(observation.position, self.place) < 3.0:
            self.place = self._advance(observation.position)
            self.patience = 20 + round(flat_distance(observation.position, self.place) * 2.0)
        return self.place

    def _advance(self, position: Vector) -> Vector:
        """Return the spiral's next place inside the map."""
        middle = self.waves[self.wave].center if self.wave >= 0 else (0.0, 0.0)
        for _ in range(1000):
            radius = self.spacing * self.angle / math.tau
            if radius > 2.0 * self.limit:
                self.angle = 0.0
                continue
            place = (
                middle[0] + radius * math.sin(self.angle),
                position[1],
                middle[1] + radius * math.cos(self.angle),
            )
            # Steps of about 10 m, wider turns near the middle.
            self.angle += min(1.5, 10.0 / max(radius, 1.0))
            if max(abs(place[0]), abs(place[2])) < self.limit:
                return place
        return (0.0, position[1], 0.0)


class Boxes:
    """Chooses a supply box to fetch. One that cannot be reached in time is ignored for a while."""

    PATIENCE = 3.0  # s beyond the time of the direct walk
    LEFT_ALONE = 25.0  # s for which a box is ignored

    def __init__(self, cost: Callable[[Vector, SupplyBox], float]) -> None:
        self.cost = cost  # of fetching a box from a position; the box with the lowest cost is chosen
        self.wanted: int | None = None
        self.give_up_at = 0.0  # s of game time
        self.left_alone: dict[int, float] = {}  # by box: the time when it may be tried again

    def choose(self, observation: Observation, is_safe: Callable[[Vector], bool]) -> Vector | None:
        """Return the position of the best box that is in a safe place and not ignored, or None."""
        now, here = observation.time, observation.position
        if self.wanted is not None and now > self.give_up_at:
            self.left_alone[self.wanted] = now + self.LEFT_ALONE
            self.wanted = None
        boxes = {
            box.id: box
            for box in observation.supply_boxes
            if self.left_alone.get(box.id, 0.0) <= now and is_safe(box.position)
        }
        if self.wanted not in boxes:
            self.wanted = min(boxes, key=lambda box: self.cost(here, boxes[box]), default=None)
            if self.wanted is not None:
                self.give_up_at = now + self.PATIENCE + flat_distance(here, boxes[self.wanted].position) / 5.0
        return None if self.wanted is None else boxes[self.wanted].position


def effort(here: Vector, box: SupplyBox) -> float:
    """Return the estimated walking distance to a box, m; it is longer if the box is on another floor."""
    return flat_distance(here, box.position) + 4.0 * abs(box.position[1] - here[1])
