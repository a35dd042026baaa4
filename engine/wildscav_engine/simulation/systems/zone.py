"""The safe zone of a royale: a circle that draws in by a seeded schedule, and hurts whoever is outside.

It begins as the circle around the whole map. Each phase waits, then moves evenly to a smaller circle that
lies inside the old one and has its middle on the map. Outside, the damage of the running phase is taken once
a second.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import Dice, Stream
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.simulation.state import Agents, Matches
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.specs.zone_config import ZoneConfig

COLUMNS = 9  # of a phase in Matches.zone


class Zone(NamedTuple):
    """The safe zone at one moment."""

    x: float  # m, of its middle
    z: float  # m
    radius: float  # m
    damage: float  # hp a second outside


def plan_zone(config: ZoneConfig, map_size: float, seed: int) -> NDArray[np.float64]:
    """Draw the circles of a schedule.

    Args:
        config: The schedule.
        map_size: m, of each side of the map.
        seed: Of the match.

    Returns:
        (Z, 9) as in ``Matches.zone``.
    """
    dice = Dice(seed, Stream.ZONE)
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
    dice: Dice, circle: tuple[float, float, float], radius: float, half: float
) -> tuple[float, float, float]:
    """Return a circle inside another, its middle on the map, every place being as likely as another."""
    x, z, outer = circle
    room = outer - radius
    while True:
        dx, dz = dice.uniform(-room, room), dice.uniform(-room, room)
        on_map = max(abs(x + dx), abs(z + dz)) <= half
        if dx * dx + dz * dz <= room * room and on_map:
            return x + dx, z + dz, radius


@kernel
def phase_at(matches: Matches, match: int, frame: int) -> int:
    """Return the phase that runs in a frame, the last one once it is over; -1 without any phase."""
    last = matches.phases[match] - 1
    for phase in range(last):
        if frame < matches.zone[match, phase, 1]:
            return phase
    return int(last)


@kernel
def zone_at(matches: Matches, match: int, frame: int) -> Zone:
    """Return the safe zone in a frame; without any phase, it is the whole plane."""
    phase = phase_at(matches, match, frame)
    if phase < 0:
        return Zone(0.0, 0.0, np.inf, 0.0)
    row = matches.zone[match, phase]
    part = min(1.0, max(0.0, (frame - row[0]) / (row[1] - row[0])))
    return Zone(
        row[2] + (row[5] - row[2]) * part,
        row[3] + (row[6] - row[3]) * part,
        row[4] + (row[7] - row[4]) * part,
        row[8],
    )


@inlined_kernel
def hurt_outside(agents: Agents, matches: Matches, match: int) -> None:
    """Once a second, note the damage of everyone outside the safe zone; nobody is invincible to it."""
    frame = matches.frame[match]
    if matches.phases[match] == 0 or frame % FRAMES_PER_SECOND != 0:
        return
    zone = zone_at(matches, match, frame)
    for seat in range(agents.health.shape[0]):
        dx, dz = agents.position[seat, 0] - zone.x, agents.position[seat, 2] - zone.z
        if agents.health[seat] > 0 and dx * dx + dz * dz > zone.radius * zone.radius:
            agents.damage[seat] += int(zone.damage)
