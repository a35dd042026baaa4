"""The lists of boxes and agents as array expressions, to compare with the kernels of the sensors.

They are slower by a factor of 5 to 10, and written independently: each number is one expression over all
matches.
"""

from collections.abc import Callable
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import arctangent, cosine, logarithm, sine, wrap
from wildscav_engine.specs.body import BODY_RADIUS, EYE_HEIGHT

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


def sights(sensor: Any, state: Any, seen: Any, seats: Seats) -> Readings:
    """What ``Sights`` reads, enemy by enemy."""
    agents = state.agents
    readings = np.zeros((len(seen.agents), len(seats), sensor.limit, 10), np.float32)
    for match, (place, seat) in product(range(len(seen.agents)), enumerate(seats)):
        count = seen.agent_count[match, seat]
        others = [
            other
            for other in seen.agents[match, seat, :count]
            if agents.team[match, other] != agents.team[match, seat]
        ]
        for row, other in zip(readings[match, place], others, strict=False):
            way = agents.position[match, other] - agents.position[match, seat]
            moved = (agents.velocity[match, other] - agents.velocity[match, seat]) * sensor.lead
            angles = []
            for x, y, z in (way, way + moved):
                off = wrap(arctangent(x, z) - agents.yaw[match, seat])
                drop = arctangent(EYE_HEIGHT - 1.1 - y, np.sqrt(x * x + z * z)) - agents.pitch[match, seat]
                angles += [np.copysign(logarithm(1.0 + abs(angle)), angle) for angle in (off, drop)]
            x, y, z = way
            level = np.sqrt(x * x + z * z)
            faces = cosine(agents.yaw[match, other] - arctangent(-x, -z))
            half_width = logarithm(1.0 + arctangent(BODY_RADIUS, level))
            distance = logarithm(1.0 + np.sqrt(level * level + y * y))
            state_of = agents.health[match, other], agents.invincible_left[match, other] > 0
            row[:] = (1.0, *angles, half_width, faces, distance, *state_of)
    return readings


def to_supplies(sensor: Any, state: Any, seen: Any, seats: Seats) -> Readings:
    """What ``ToSupplies`` reads, reader by reader."""
    boxes, agents = state.supplies, state.agents
    readings = np.zeros((len(seen.supplies), len(seats), sensor.limit, 6), np.float32)
    for match, (place, seat) in product(range(len(seen.supplies)), enumerate(seats)):
        slots = seen.supplies[match, seat, : seen.supply_count[match, seat]]
        x, y, z = (boxes.position[match, slots] - agents.position[match, seat]).T
        level, quantity = np.sqrt(x * x + z * z), boxes.quantity[match, slots]
        efforts = sensor.start_up + level + 4.0 * np.abs(y)
        costs = [
            logarithm(effort) - sensor.worth * logarithm(float(held))
            for effort, held in zip(efforts, quantity, strict=True)
        ]
        yaw = agents.yaw[match, seat]
        for row, box in zip(readings[match, place], np.argsort(costs, kind="stable"), strict=False):
            right = (x[box] * cosine(yaw) - z[box] * sine(yaw)) / level[box]
            ahead = (x[box] * sine(yaw) + z[box] * cosine(yaw)) / level[box]
            logs = logarithm(1.0 + level[box]), logarithm(1.0 + float(quantity[box]))
            row[:] = (1.0, np.clip(right, -1.0, 1.0), np.clip(ahead, -1.0, 1.0), y[box], *logs)
    return readings


ARRAY_SENSORS: dict[str, Callable[[Any, Any, Any, Seats], Readings]] = {
    "visible_agents": visible_agents,
    "teammates": teammates,
    "nearby_supplies": nearby_supplies,
    "sights": sights,
    "to_supplies": to_supplies,
}
