"""Following a way point by point, as fast as its corners allow, and noticing what blocks it."""

from typing import NamedTuple

from wildscav.agent import Observation, Vector
from wildscav.geometry import direction_to, flat_distance, moved
from wildscav.skills.paths import Way
from wildscav.skills.surroundings import CELL, Surroundings

FULL_SPEED = 10.0  # m/s
AHEAD = 12  # points of the way that are checked for obstacles that were seen since
STRAYED = 1.6  # m from the way, at which it is given up
JUMP_STEPS = 3  # steps without progress after which it jumps
GIVE_UP_STEPS = 9  # steps without progress after which something unseen is in the way


class Walk(NamedTuple):
    """How to walk during a step."""

    direction: float  # degrees, compass
    speed: float  # m/s
    jump: bool = False  # over what may be low


def hold(here: Vector, place: Vector, step_time: float) -> Walk:
    """Return how to walk straight to a place and to stand there.

    No step, of ``step_time`` seconds, leads past it.
    """
    return Walk(direction_to(here, place), min(FULL_SPEED, flat_distance(here, place) / step_time))


class WayWalker:
    """Follows one way at a time."""

    def __init__(self, surroundings: Surroundings, step_time: float) -> None:
        """Begin without a way; a step takes ``step_time`` seconds of game time.

        Obstacles that the LIDAR does not show are noted in ``surroundings``.
        """
        self.surroundings = surroundings
        self.pace = FULL_SPEED * step_time  # m in a step
        self.points: tuple[Vector, ...] = ()
        self.next = 0  # index of the point that it walks to
        self.still = 0  # steps without progress

    def take(self, way: Way) -> None:
        """Begin to follow a way."""
        self.points, self.next, self.still = way.points, 0, 0

    def stop(self) -> None:
        """Follow no way any more."""
        self.points = ()

    @property
    def is_walking(self) -> bool:
        """Whether there is a way to follow."""
        return bool(self.points)

    def walk(self, observation: Observation) -> Walk | None:
        """Return how to walk on, or None when the way ends, is lost or is blocked."""
        here = observation.position
        before = self.next
        self._pass_points(here)
        self.still = 0 if self.next > before else self.still + 1
        if self.next >= len(self.points) or flat_distance(here, self.points[self.next]) > STRAYED:
            self.stop()
            return None
        if not all(map(self.surroundings.is_free, self.points[self.next : self.next + AHEAD])):
            self.stop()
            return None
        goal = self.points[self.next]
        direction = direction_to(here, goal)
        if self.still > GIVE_UP_STEPS:
            self.surroundings.block(moved(here, direction, min(flat_distance(here, goal), 2.0 * CELL)))
            self.stop()
            return None
        if self.still >= JUMP_STEPS:
            return Walk(direction, FULL_SPEED, jump=True)
        speed = min(FULL_SPEED, FULL_SPEED * flat_distance(here, goal) / self.pace)
        return Walk(direction, max(speed, 2.0))

    def _pass_points(self, here: Vector) -> None:
        """Choose the farthest point that is within the reach of one step along the way."""
        ahead = range(self.next, min(self.next + 6, len(self.points)))
        near = [index for index in ahead if flat_distance(here, self.points[index]) < CELL * 0.75]
        self.next = near[-1] + 1 if near else self.next
        following = self.points[self.next + 1 :]
        for point in following:
            if flat_distance(here, point) >= self.pace:
                break
            self.next += 1
