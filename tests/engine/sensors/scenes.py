"""Small matches that sensors are read in."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tests.builders import flat_world, lay_boxes, make_match, place

from wildscav_engine.geometry.world import Solid, World
from wildscav_engine.sensors import Sensor
from wildscav_engine.simulation.match import Match


def duel(
    *solids: Solid, track: str = "battle", distance: float = 6.0, water: float = -np.inf, **spec: Any
) -> Match:
    """Seat 0 at the origin, looking north; seat 1 so many metres north of it, looking back; no boxes."""
    match = make_match(track, flat_world(80, solids, water=water), seats=2, **spec)
    match.state.agents.invincible_left[:] = 0
    lay_boxes(match)
    place(match, 0, (0, 0, 0))
    place(match, 1, (0, 0, distance), 180.0)
    return match


def read(
    sensor: Sensor, world: World, yaw: float = 0.0, pitch: float = 0.0, at: Sequence[float] = (0, 0, 0)
) -> NDArray[Any]:
    """The reading of the only agent of a match."""
    match = make_match(world=world)
    place(match, 0, at, yaw, pitch)
    return sensor.read(match, [0])[0]
