"""The safe zone of a royale: where it is, where it will be, and how long it takes to shrink.

Eleven numbers: 1 if the match has a zone; the agent's distance inside the edge (m, negative outside); the
center of the zone relative to the agent (x east and z north, m) and its radius (m); the same three numbers of
the next circle, to which the zone shrinks; the time until it begins to shrink (s, 0 while it does) and until
it has shrunk (s); and the damage outside (hp per second). All are 0 if the match has no zone. After the last
phase, the two circles are equal.
"""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.sensors.base import Column, sensor
from wildscav_engine.sensors.scalars import ScalarSensor, Write
from wildscav_engine.simulation.state import Agents, Matches
from wildscav_engine.simulation.systems.zone import phase_at, zone_at
from wildscav_engine.specs.rules import FRAME

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


@kernel
def _write_zone(agents: Agents, matches: Matches, match: int, seat: int, row: NDArray[np.float32]) -> None:
    """Write what a seat knows about the zone; all 0 if there is none."""
    frame = matches.frame[match]
    phase = phase_at(matches, match, frame)
    if phase < 0:
        return
    zone, schedule = zone_at(matches, match, frame), matches.zone[match, phase]
    x, z = agents.position[match, seat, 0], agents.position[match, seat, 2]
    to_x, to_z = zone.x - x, zone.z - z
    row[0] = 1.0
    row[1] = zone.radius - np.sqrt(to_x * to_x + to_z * to_z)
    row[2], row[3], row[4] = to_x, to_z, zone.radius
    row[5], row[6], row[7] = schedule[5] - x, schedule[6] - z, schedule[7]
    row[8] = max(0.0, schedule[0] - frame) * FRAME
    row[9] = max(0.0, schedule[1] - frame) * FRAME
    row[10] = zone.damage


@sensor
class SafeZone(ScalarSensor):
    """The safe zone and its next circle."""

    name: ClassVar[str] = "zone"
    title: ClassVar[str] = (
        "the safe zone: present, m inside its edge, its center from the agent, m, and radius, m; the next "
        "center and radius, m; s until it shrinks and until it has shrunk; hp per second outside"
    )
    scalars: ClassVar[tuple[Column, ...]] = COLUMNS

    @staticmethod
    def kernel() -> Write:
        """Return the kernel that writes the numbers."""
        return _write_zone
