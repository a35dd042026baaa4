"""Staying in the safe zone of a royale."""

import math
from typing import NamedTuple

from wildscav.agent import Observation, Vector
from wildscav.geometry import flat_distance


class Caution(NamedTuple):
    """How early an agent goes to the next circle. The default takes the time that most ways take."""

    margin: float = 5.0  # m to keep from the edge of the zone
    pace: float = 5.0  # m/s on the way to the next circle: half of the full speed, because of detours
    spare: float = 2.0  # s by which to be early in the next circle


USUAL = Caution()


class Circle(NamedTuple):
    """A circle on the ground."""

    center: Vector  # m
    radius: float  # m

    def depth(self, place: Vector) -> float:
        """Return how far inside the edge a place is, m; negative outside."""
        return self.radius - flat_distance(self.center, place)


class SafeZone(NamedTuple):
    """The safe zone and the next circle inside it, to which it shrinks, as an agent knows them."""

    here: Vector  # where the agent is
    now: Circle  # the zone
    next: Circle  # to which it shrinks
    shrunk_in: float  # s until the zone has shrunk to the next circle
    caution: Caution = USUAL  # how early the agent goes to the next circle

    def is_safe(self, place: Vector) -> bool:
        """Return whether the agent can go to a place and from there to the next circle in time."""
        if self.now.depth(place) < self.caution.margin:
            return False
        way_back = max(0.0, -self.next.depth(place))
        way = flat_distance(self.here, place) + way_back
        return way_back == 0.0 or way / self.caution.pace + self.caution.spare <= self.shrunk_in


def safe_zone(observation: Observation, caution: Caution = USUAL) -> SafeZone:
    """Return the safe zone, which has no edge in a match without one. It is read from the sensor ``zone``.

    A server on which the agent plays by hand may not offer that sensor; then no zone is known.
    """
    x, y, z = observation.position
    reading = observation.tensors.get("zone")
    if reading is None or not reading[0]:
        everywhere = Circle(observation.position, math.inf)
        return SafeZone(observation.position, everywhere, everywhere, math.inf, caution)
    _, _, *circles, _, shrunk_in, _ = (float(number) for number in reading)
    now_x, now_z, now_radius, next_x, next_z, next_radius = circles
    return SafeZone(
        here=observation.position,
        now=Circle((x + now_x, y, z + now_z), now_radius),
        next=Circle((x + next_x, y, z + next_z), next_radius),
        shrunk_in=shrunk_in,
        caution=caution,
    )
