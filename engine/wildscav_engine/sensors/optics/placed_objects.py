"""Agents and supply boxes that are placed by hand, for images without a match."""

from collections.abc import Sequence

import numpy as np

from wildscav_engine.rendering.dynamic_objects import DynamicObjects
from wildscav_engine.sensors.optics.dynamic_objects import dynamic_objects_in
from wildscav_engine.simulation.state import allocate_state

Position = tuple[float, float, float]  # m, on the ground


def placed_objects(agents: Sequence[tuple[Position, float]], boxes: Sequence[Position]) -> DynamicObjects:
    """Return agents and boxes as images show them.

    Args:
        agents: The position and the yaw in degrees of each agent; each is in a team of its own.
        boxes: The position of each box.
    """
    state = allocate_state(1, len(agents), len(boxes))
    state.agents.present[:], state.agents.health[:] = True, 1
    state.agents.team[0] = np.arange(len(agents))
    state.agents.position[0] = np.array([place for place, _ in agents]).reshape(-1, 3)
    state.agents.yaw[0] = [yaw for _, yaw in agents]
    state.supplies.quantity[:], state.supplies.serial[0] = 1, np.arange(len(boxes))
    state.supplies.position[0] = np.array(boxes).reshape(-1, 3)
    return dynamic_objects_in(state)
