"""The nearest enemies in sight relative to the view, as a learner can aim by it.

Each row describes one enemy, nearest first: 1; how far its chest is to the right of where the agent looks and
how far below, now and after ``lead`` seconds if both keep their velocities; half the width of its body; the
cosine of how far it looks past the agent; the logarithm of its distance; its health (hp); and 1 if it is
invincible. Angles are sign(a) · ln(1 + |a|) with a in degrees, so that a network can tell 1° from 2° as well
as 30° from 60°. Unused rows are 0. ``visibility.py`` decides which agents are in sight. Unless the rule
``senses`` is ``original``, the health is 0, and the enemy counts as standing still.
"""

from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.arithmetic.elementary_functions import arctangent, cosine, logarithm, wrap
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.compilation.tables.array_tables import Addresses
from wildscav_engine.sensors.base import Column, Sight, StateSensor, sensor
from wildscav_engine.simulation.state import agents_at
from wildscav_engine.simulation.systems.visibility import AGENT_LIMIT
from wildscav_engine.specs.body import BODY_RADIUS, EYE_HEIGHT

if TYPE_CHECKING:
    from wildscav_engine.simulation.state import State
    from wildscav_engine.simulation.systems.visibility import Seen

CHEST_HEIGHT = 1.1  # m above the soles
WIDEST = 5.3  # ln °, above ln(1 + 180)


@sensor
class Sights(StateSensor):
    """The nearest enemies in sight, relative to the view."""

    name: ClassVar[str] = "sights"
    sight: ClassVar[Sight] = "own"
    title: ClassVar[str] = (
        "enemies in sight: present; right of and below the view, now and soon, and half width, ln degrees; "
        "faces, of 1; log distance, ln m; health, hp; invincible"
    )
    scalars: ClassVar[tuple[Column, ...]] = (
        Column("present", "0 or 1", 0, 1, "whether the row describes an enemy"),
        Column("right", "ln degrees", -WIDEST, WIDEST, "how far its chest is to the right of the view"),
        Column("below", "ln degrees", -WIDEST, WIDEST, "how far its chest is below the view"),
        Column("right soon", "ln degrees", -WIDEST, WIDEST, "how far to the right it will be"),
        Column("below soon", "ln degrees", -WIDEST, WIDEST, "how far below it will be"),
        Column("half width", "ln degrees", 0, WIDEST, "half the width of its body"),
        Column("faces", "of 1", -1, 1, "1 if it looks at the agent, -1 if it looks away"),
        Column("log distance", "ln m", 0, 10, "logarithm of 1 m + its distance"),
        Column("health", "hp", 0, 10_000, "its health"),
        Column("invincible", "0 or 1", 0, 1, "whether it is invincible now"),
    )

    limit: Annotated[int, Field(ge=1, le=AGENT_LIMIT)] = 2  # rows: enemies, the nearest ones
    lead: Annotated[float, Field(ge=0, le=2)] = 0.1  # s from now to "soon" in the columns

    def read_batch(self, state: "State", seen: "Seen", seats: NDArray[np.int64]) -> NDArray[np.float32]:
        """Return (B, len(seats), limit, 10)."""
        readings = np.zeros((len(seen.agents), len(seats), self.limit, len(self.scalars)), np.float32)
        table = state.tables[0].addresses
        sight = seen.agents, seen.agent_count, seen.tells_condition
        _write_sights(*sight, table, seats, self.lead, readings)
        return readings


@kernel
def _write_sights(
    others: NDArray[np.int32],
    count: NDArray[np.int32],
    tells_condition: NDArray[np.bool_],
    table: Addresses,
    seats: NDArray[np.int64],
    lead: float,
    readings: NDArray[np.float32],
) -> None:
    """Write what some seats, (S,), of all matches see of their enemies, into zeros (B, S, limit, columns).

    The first three are as in ``Seen``, the table is that of the agents, and ``lead`` is in s.
    """
    agents = agents_at(table)
    team, yaw, pitch = agents.team, agents.yaw, agents.pitch
    for match in range(readings.shape[0]):
        for reader in range(seats.shape[0]):
            seat, written = seats[reader], 0
            for place in range(count[match, seat]):
                other = others[match, seat, place]
                if written == readings.shape[2] or team[match, other] == team[match, seat]:
                    continue
                row = readings[match, reader, written]
                written += 1
                own, there = agents.position[match, seat], agents.position[match, other]
                x, y, z = there[0] - own[0], there[1] - own[1], there[2] - own[2]
                level = np.sqrt(x * x + z * z)
                row[0] = 1.0
                _write_angles(x, y, z, yaw[match, seat], pitch[match, seat], row[1:3])
                own, there = agents.velocity[match, seat], agents.velocity[match, other]
                known = 1.0 if tells_condition[match, seat] else 0.0
                soon_x = x + (there[0] * known - own[0]) * lead
                soon_y = y + (there[1] * known - own[1]) * lead
                soon_z = z + (there[2] * known - own[2]) * lead
                _write_angles(soon_x, soon_y, soon_z, yaw[match, seat], pitch[match, seat], row[3:5])
                row[5] = signed_logarithm(arctangent(BODY_RADIUS, level))
                row[6] = cosine(yaw[match, other] - arctangent(-x, -z))
                row[7] = logarithm(1.0 + np.sqrt(level * level + y * y))
                row[8] = agents.health[match, other] * known
                row[9] = agents.invincible_left[match, other] > 0


@kernel
def _write_angles(x: float, y: float, z: float, yaw: float, pitch: float, row: NDArray[np.float32]) -> None:
    """Write (2,) how far a chest is to the right of a view and below it; x, y, z lead from soles to soles."""
    level = np.sqrt(x * x + z * z)
    row[0] = signed_logarithm(wrap(arctangent(x, z) - yaw))
    row[1] = signed_logarithm(arctangent(EYE_HEIGHT - CHEST_HEIGHT - y, level) - pitch)


@kernel
def signed_logarithm(angle: float) -> float:
    """Return sign(a) · ln(1 + |a|) of an angle in degrees."""
    return logarithm(1.0 + angle) if angle >= 0.0 else -logarithm(1.0 - angle)
