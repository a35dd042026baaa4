"""The safe zone of a royale: a circle that shrinks on a schedule and damages agents outside it.

It starts as the circle around the whole map. Each phase waits, then moves at constant speed to a smaller
circle that lies inside the old one and has its center on the map. Agents outside take the damage of the
current phase once per second.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.simulation.state import Agents, Matches
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.specs.zone_config import ZoneConfig

COLUMNS = 9  # of a phase in Matches.zone


class Zone(NamedTuple):
    """The safe zone at one moment."""

    x: float  # m, of its center
    z: float  # m
    radius: float  # m
    damage: float  # hp per second outside


def plan_zone(config: ZoneConfig, map_size: float, seed: int) -> NDArray[np.float64]:
    """Draw (Z, 9) the circles of a schedule, as in ``Matches.zone``, on a map with sides of so many m."""
    dice = RandomStream(seed, Stream.ZONE)
    rows = np.zeros((len(config.phases), COLUMNS))
    frame, half = 0, map_size / 2
    circle = (0.0, 0.0, half * float(np.sqrt(2.0)))
    for row, phase in zip(rows, config.phases, strict=True):
        start = frame + round(phase.wait * FRAMES_PER_SECOND)
        frame = start + max(1, round(phase.shrink * FRAMES_PER_SECOND))
        inner = _circle_inside(dice, circle, circle[2] * phase.share, half)
        row[:] = start, frame, *circle, *inner, phase.damage
        circle = inner
    return rows


def _circle_inside(
    dice: RandomStream, circle: tuple[float, float, float], radius: float, half: float
) -> tuple[float, float, float]:
    """Return a circle inside another with its center on the map, uniformly distributed."""
    x, z, outer = circle
    margin = outer - radius
    while True:
        dx, dz = dice.uniform(-margin, margin), dice.uniform(-margin, margin)
        on_map = max(abs(x + dx), abs(z + dz)) <= half
        if dx * dx + dz * dz <= margin * margin and on_map:
            return x + dx, z + dz, radius


@kernel
def phase_at(matches: Matches, match: int, frame: int) -> int:
    """Return the phase of a frame; after the last phase, the last one; -1 if there are no phases."""
    return _phase_of(matches.zone[match, : matches.phases[match]], frame)


@kernel
def _phase_of(rows: NDArray[np.float64], frame: int) -> int:
    last = rows.shape[0] - 1
    for phase in range(last):
        if frame < rows[phase, 1]:
            return phase
    return int(last)


@kernel
def zone_at(matches: Matches, match: int, frame: int) -> Zone:
    """Return the safe zone in a frame; without phases, it is the whole plane."""
    return zone_planned(matches.zone[match, : matches.phases[match]], frame)


@kernel
def zone_planned(rows: NDArray[np.float64], frame: int) -> Zone:
    """Return the safe zone in a frame, given (Z, 9) its phases as ``plan_zone`` returns them."""
    phase = _phase_of(rows, frame)
    if phase < 0:
        return Zone(0.0, 0.0, np.inf, 0.0)
    row = rows[phase]
    part = min(1.0, max(0.0, (frame - row[0]) / (row[1] - row[0])))
    return Zone(
        row[2] + (row[5] - row[2]) * part,
        row[3] + (row[6] - row[3]) * part,
        row[4] + (row[7] - row[4]) * part,
        row[8],
    )


@inlined_kernel
def damage_outside_zone(agents: Agents, matches: Matches, match: int) -> None:
    """Once per second, add damage to all agents outside the safe zone, even if they are invincible."""
    frame = matches.frame[match]
    if matches.phases[match] == 0 or frame % FRAMES_PER_SECOND != 0:
        return
    zone = zone_at(matches, match, frame)
    for seat in range(agents.health.shape[0]):
        dx, dz = agents.position[seat, 0] - zone.x, agents.position[seat, 2] - zone.z
        if agents.health[seat] > 0 and dx * dx + dz * dz > zone.radius * zone.radius:
            agents.damage[seat] += int(zone.damage)
