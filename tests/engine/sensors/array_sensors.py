"""The lists of boxes and agents as array expressions, to compare with the kernels of the sensors.

They are slower by a factor of 5 to 10, and written independently: each number is one expression over all
matches.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Seats = NDArray[np.int64]
Readings = NDArray[np.float32]


def nearby_supplies(sensor: Any, state: Any, seen: Any, seats: Seats) -> Readings:
    """What ``NearbySupplies`` reads."""
    boxes, position = state.supplies, state.agents.position
    match, reader, place = np.nonzero(np.arange(sensor.limit) < seen.supply_count[:, seats, None])
    slots = seen.supplies[match, seats[reader], place]
    x, y, z = (boxes.position[match, slots] - position[match, seats[reader]]).T
    distance = np.sqrt(x * x + y * y + z * z)
    columns = np.stack((np.ones(len(slots)), boxes.quantity[match, slots], x, y, z, distance), axis=-1)
    near = distance <= sensor.range
    readings = np.zeros((len(seen.supplies), len(seats), sensor.limit, 6), np.float32)
    readings[match[near], reader[near], place[near]] = columns[near]
    return readings


def visible_agents(sensor: Any, state: Any, seen: Any, seats: Seats) -> Readings:
    """What ``VisibleAgents`` reads."""
    agents = state.agents
    match, reader, place = np.nonzero(np.arange(sensor.limit) < seen.agent_count[:, seats, None])
    others = seen.agents[match, seats[reader], place]
    columns = (
        *(np.ones(len(others)), others, agents.team[match, others]),
        *_motion(agents, match, seats[reader], others),
        *(agents.health[match, others], agents.invincible_left[match, others] > 0),
    )
    readings = np.zeros((len(seen.agents), len(seats), sensor.limit, 13), np.float32)
    readings[match, reader, place] = np.stack(columns, axis=-1)
    return readings


def teammates(sensor: Any, state: Any, seen: Any, seats: Seats) -> Readings:
    """What ``Teammates`` reads."""
    agents, every = state.agents, np.arange(state.agents.team.shape[1])
    is_mate = agents.team[:, None] == agents.team[:, seats, None]
    is_mate &= (every != seats[:, None]) & (every < state.matches.seats[:, None, None])
    offsets = agents.position[:, None] - agents.position[:, seats, None]
    squares = np.where(is_mate, (offsets * offsets).sum(axis=-1), np.inf)
    order = np.argsort(squares, axis=-1, kind="stable")
    match, reader, place = np.nonzero(np.arange(sensor.limit) < is_mate.sum(axis=-1)[..., None])
    mates = order[match, reader, place]
    columns = (
        *(np.ones(len(mates)), mates),
        *_motion(agents, match, seats[reader], mates),
        *(agents.health[match, mates], agents.invincible_left[match, mates] > 0),
        agents.supplies[match, mates],
    )
    readings = np.zeros((*is_mate.shape[:2], sensor.limit, 13), np.float32)
    readings[match, reader, place] = np.stack(columns, axis=-1)
    return readings


def _motion(agents: Any, match: Any, own: Any, others: Any) -> tuple[Any, ...]:
    x, y, z = (agents.position[match, others] - agents.position[match, own]).T
    distance = np.sqrt(x * x + y * y + z * z)
    return x, y, z, distance, *agents.velocity[match, others].T, agents.yaw[match, others]


ARRAY_SENSORS: dict[str, Callable[[Any, Any, Any, Seats], Readings]] = {
    "visible_agents": visible_agents,
    "teammates": teammates,
    "nearby_supplies": nearby_supplies,
}
