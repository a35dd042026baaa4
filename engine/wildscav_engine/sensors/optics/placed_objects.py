"""Agents and supply boxes put somewhere by hand, for pictures without a match."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from wildscav_engine.rendering.dynamic_objects import DynamicObjects
from wildscav_engine.sensors.optics.dynamic_objects import dynamic_objects_of
from wildscav_engine.simulation.state import State, allocate_state

Place = tuple[float, float, float]  # m, on the ground


class _Moment(NamedTuple):
    """What images want to know of a match."""

    state: State
    frame: int = 0


def placed_objects(agents: Sequence[tuple[Place, float]], boxes: Sequence[Place]) -> DynamicObjects:
    """Return agents and boxes as images show them.

    Args:
        agents: Where each stands and its yaw in degrees; each is a team of its own.
        boxes: Where each stands.
    """
    state = allocate_state(1, len(agents), len(boxes))
    state.agents.present[:], state.agents.health[:] = True, 1
    state.agents.team[0] = np.arange(len(agents))
    state.agents.position[0] = np.array([place for place, _ in agents]).reshape(-1, 3)
    state.agents.yaw[0] = [yaw for _, yaw in agents]
    state.supplies.quantity[:], state.supplies.serial[0] = 1, np.arange(len(boxes))
    state.supplies.position[0] = np.array(boxes).reshape(-1, 3)
    return dynamic_objects_of(_Moment(state))
