"""The safe zone of a royale: where it is, where it will be, and how long it takes to shrink.

Eleven numbers: 1 if the match has a zone; the agent's distance inside the edge (m, negative outside); the
center of the zone relative to the agent (x east and z north, m) and its radius (m); the same three numbers of
the next circle, to which the zone shrinks; the time until it begins to shrink (s, 0 while it does) and until
it has shrunk (s); and the damage outside (hp per second). All are 0 if the match has no zone. After the last
phase, the two circles are equal.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.sensors.base import Column, Sensor, row_space, rows_of, sensor
from wildscav_engine.simulation.systems.zone import phase_at, zone_at
from wildscav_engine.specs.rules import FRAME

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.simulation.match_view import MatchView

INF = np.inf
COLUMNS = (
    Column("present", "0 or 1", 0, 1, "whether the match has a zone"),
    Column("inside", "m", -INF, INF, "the agent's distance inside the zone's edge; negative outside"),
    Column("x", "m", -INF, INF, "the zone's center, east of the agent"),
    Column("z", "m", -INF, INF, "the zone's center, north of the agent"),
    Column("radius", "m", 0, INF, "the zone's radius"),
    Column("next_x", "m", -INF, INF, "the center of the next circle, east of the agent"),
    Column("next_z", "m", -INF, INF, "the center of the next circle, north of the agent"),
    Column("next_radius", "m", 0, INF, "the radius of the next circle"),
    Column("shrinks_in", "s", 0, INF, "time until the zone begins to shrink; 0 while it does"),
    Column("shrunk_in", "s", 0, INF, "time until the zone has shrunk to the next circle"),
    Column("damage", "hp/s", 0, 10_000, "damage outside the zone"),
)


@sensor
class SafeZone(Sensor):
    """The safe zone and its next circle."""

    name: ClassVar[str] = "zone"
    title: ClassVar[str] = (
        "the safe zone: present, m inside its edge, its center from the agent, m, and radius, m; the next "
        "center and radius, m; s until it shrinks and until it has shrunk; hp per second outside"
    )

    @property
    def columns(self) -> tuple[Column, ...]:
        """The columns of a reading."""
        return COLUMNS

    @property
    def space(self) -> "Box":
        """(11,)."""
        return row_space(COLUMNS)

    def read(self, match: "MatchView", seats: Sequence[int]) -> NDArray[np.float32]:
        """Return (len(seats), 11).

        Raises:
            ValueError: The match has no such seat.
        """
        rows = rows_of(match, seats)
        readings = np.zeros((len(rows), len(COLUMNS)), np.float32)
        matches, frame = match.state.matches, match.frame
        phase = phase_at(matches, 0, frame)
        if phase < 0:
            return readings
        zone = zone_at(matches, 0, frame)
        start, end, *_, next_x, next_z, next_radius, _ = matches.zone[0, phase]
        x, z = match.state.agents.position[0, rows][:, [0, 2]].T
        to_x, to_z = zone.x - x, zone.z - z
        readings[:, 0] = 1.0
        readings[:, 1] = zone.radius - np.sqrt(to_x * to_x + to_z * to_z)
        readings[:, 2], readings[:, 3], readings[:, 4] = to_x, to_z, zone.radius
        readings[:, 5], readings[:, 6], readings[:, 7] = next_x - x, next_z - z, next_radius
        readings[:, 8] = max(0.0, start - frame) * FRAME
        readings[:, 9] = max(0.0, end - frame) * FRAME
        readings[:, 10] = zone.damage
        return readings
