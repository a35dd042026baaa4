"""Other agents as arrays: those in sight, and teammates anywhere."""

from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.compilation.tables.array_tables import Addresses
from wildscav_engine.sensors.base import Column, Sight, StateSensor, sensor
from wildscav_engine.simulation.state import Agents, agents_at, matches_at
from wildscav_engine.simulation.systems.visibility import AGENT_LIMIT, insert_nearest

if TYPE_CHECKING:
    from wildscav_engine.simulation.state import State
    from wildscav_engine.simulation.systems.visibility import Seen

MAX_SUPPLIES = 2.0**31  # carried: the bound of a 32-bit count
# Seats and teams are numbers below 1000; rules allow 10,000 hp at most.
INF = np.inf
MOTION_COLUMNS = (
    Column("x", "m", -INF, INF, "position east of the agent's soles"),
    Column("y", "m", -INF, INF, "position above the agent's soles"),
    Column("z", "m", -INF, INF, "position north of the agent's soles"),
    Column("distance", "m", 0, INF, "distance from the agent's soles"),
    Column("velocity_x", "m/s", -INF, INF, "its velocity to the east"),
    Column("velocity_y", "m/s", -INF, INF, "its velocity upwards"),
    Column("velocity_z", "m/s", -INF, INF, "its velocity to the north"),
    Column("yaw", "degrees", -180, 180, "where it faces: 0 is north, 90 is east"),
)


@kernel
def _write_other(
    agents: Agents, match: int, seat: int, other: int, with_condition: bool, row: NDArray[np.float32]
) -> None:
    """Write (10,) ``MOTION_COLUMNS`` of another seat, its health, and whether it is invincible.

    Without its condition, its velocity and its health stay as they are in the row: 0.
    """
    own, there = agents.position[match, seat], agents.position[match, other]
    x, y, z = there[0] - own[0], there[1] - own[1], there[2] - own[2]
    row[0], row[1], row[2] = x, y, z
    row[3] = np.sqrt(x * x + y * y + z * z)
    if with_condition:
        for axis in range(3):
            row[4 + axis] = agents.velocity[match, other, axis]
        row[8] = agents.health[match, other]
    row[7] = agents.yaw[match, other]
    row[9] = agents.invincible_left[match, other] > 0


@sensor
class VisibleAgents(StateSensor):
    """The nearest agents in sight: what ``agents`` of an observation lists.

    Each row describes one agent, nearest first. ``visibility.py`` decides which agents are in sight. Velocity
    and health are 0 unless the rule ``senses`` is ``original``.
    """

    name: ClassVar[str] = "visible_agents"
    sight: ClassVar[Sight] = "own"
    title: ClassVar[str] = (
        "agents in sight: present, seat, team, position from the soles, m, distance, m, velocity, m/s, "
        "yaw, degrees, health, hp, invincible"
    )
    scalars: ClassVar[tuple[Column, ...]] = (
        Column("present", "0 or 1", 0, 1, "whether the row describes an agent"),
        Column("seat", "", 0, 999, "its seat"),
        Column("team", "", 0, 999, "its team"),
        *MOTION_COLUMNS,
        Column("health", "hp", 0, 10_000, "its health"),
        Column("invincible", "0 or 1", 0, 1, "whether it is invincible now"),
    )

    limit: Annotated[int, Field(ge=1, le=AGENT_LIMIT)] = AGENT_LIMIT  # rows: agents, the nearest ones

    def read_batch(self, state: "State", seen: "Seen", seats: NDArray[np.int64]) -> NDArray[np.float32]:
        """Return (B, len(seats), limit, 13)."""
        readings = np.zeros((len(seen.agents), len(seats), self.limit, len(self.scalars)), np.float32)
        table = state.tables[0].addresses
        _write_agents(seen.agents, seen.agent_count, seen.tells_condition, table, seats, readings)
        return readings


@kernel
def _write_agents(
    others: NDArray[np.int32],
    count: NDArray[np.int32],
    tells_condition: NDArray[np.bool_],
    table: Addresses,
    seats: NDArray[np.int64],
    readings: NDArray[np.float32],
) -> None:
    """Write what some seats, (S,), of all matches see of other agents, into zeros (B, S, limit, columns).

    ``others``, ``count`` and ``tells_condition`` are as in ``Seen``, and the table is that of the agents.
    """
    agents = agents_at(table)
    for match in range(readings.shape[0]):
        for reader in range(seats.shape[0]):
            seat = seats[reader]
            for place in range(min(readings.shape[2], count[match, seat])):
                other, row = others[match, seat, place], readings[match, reader, place]
                row[0], row[1], row[2] = 1.0, other, agents.team[match, other]
                _write_other(agents, match, seat, other, tells_condition[match, seat], row[3:13])


@sensor
class Teammates(StateSensor):
    """The nearest teammates: agents know their positions and condition, in sight or not.

    Each row describes one teammate, nearest first; at equal distance, the lower seat comes first.
    """

    name: ClassVar[str] = "teammates"
    sight: ClassVar[Sight] = "none"
    title: ClassVar[str] = (
        "teammates: present, seat, position from the soles, m, distance, m, velocity, m/s, yaw, degrees, "
        "health, hp, invincible, supplies"
    )
    scalars: ClassVar[tuple[Column, ...]] = (
        Column("present", "0 or 1", 0, 1, "whether the row describes a teammate"),
        Column("seat", "", 0, 999, "its seat"),
        *MOTION_COLUMNS,
        Column("health", "hp", 0, 10_000, "its health; 0 if it is dead"),
        Column("invincible", "0 or 1", 0, 1, "whether it is invincible now"),
        Column("supplies", "", 0, MAX_SUPPLIES, "supplies that it carries"),
    )

    limit: Annotated[int, Field(ge=1, le=64)] = 7  # rows: teammates, the nearest ones

    def read_batch(
        self,
        state: "State",
        seen: "Seen",  # noqa: ARG002
        seats: NDArray[np.int64],
    ) -> NDArray[np.float32]:
        """Return (B, len(seats), limit, 13)."""
        agents, _, matches = state.tables
        readings = np.zeros((len(state.agents.team), len(seats), self.limit, len(self.scalars)), np.float32)
        scratch = np.empty(self.limit), np.empty(self.limit, np.int32)
        _write_teammates(agents.addresses, matches.addresses, seats, *scratch, readings)
        return readings


@kernel
def _write_teammates(
    table: Addresses,
    table_of_matches: Addresses,
    seats: NDArray[np.int64],
    squares: NDArray[np.float64],
    nearest: NDArray[np.int32],
    readings: NDArray[np.float32],
) -> None:
    """Write where the teammates of some seats, (S,), of all matches are, into zeros (B, S, limit, columns).

    The tables are those of the agents and of the matches. There is scratch (limit,) for the squared distances
    of the nearest teammates in m², and for their seats.
    """
    agents, seats_of_match = agents_at(table), matches_at(table_of_matches).seats
    for match in range(readings.shape[0]):
        for reader in range(seats.shape[0]):
            seat = seats[reader]
            teams = agents.team[match, : seats_of_match[match]]
            count = _find_teammates(teams, agents.position[match], seat, squares, nearest)
            for place in range(count):
                mate, row = nearest[place], readings[match, reader, place]
                row[0], row[1] = 1.0, mate
                _write_other(agents, match, seat, mate, True, row[2:12])
                row[12] = agents.supplies[match, mate]


@kernel
def _find_teammates(
    team: NDArray[np.int32],
    position: NDArray[np.float64],
    seat: int,
    squares: NDArray[np.float64],
    nearest: NDArray[np.int32],
) -> int:
    """Find the nearest teammates of a seat, in sight or not, and return their number."""
    count = 0
    for mate in range(team.shape[0]):
        if mate == seat or team[mate] != team[seat]:
            continue
        x = position[mate, 0] - position[seat, 0]
        y = position[mate, 1] - position[seat, 1]
        z = position[mate, 2] - position[seat, 2]
        count = insert_nearest(x * x + y * y + z * z, mate, count, squares, nearest)
    return count
