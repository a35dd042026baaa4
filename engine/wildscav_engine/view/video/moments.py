"""The state of a match between two steps: pictures are shown more often than steps are played."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.rendering.dynamic_objects import DynamicObjects
from wildscav_engine.sensors.optics.dynamic_objects import dynamic_objects_in
from wildscav_engine.simulation.state import allocate_state
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.view.recording.history import Boxes, History

FASTEST = 30.0  # m/s; who is farther away after a step was moved, for example by a respawn


class InterpolatedState(NamedTuple):
    """A match at one time, which may lie between two steps."""

    frame: float
    row: int  # of the history: the last step that has been played
    position: NDArray[np.float64]  # (A, 3) m
    yaw: NDArray[np.float64]  # (A,) degrees
    pitch: NDArray[np.float64]  # (A,) degrees
    alive: NDArray[np.bool_]  # (A,)


def moment_at(history: History, frame: float) -> InterpolatedState:
    """Return the match at a time; what moves does so evenly between two steps."""
    last = len(history.frame) - 1
    row = int(np.clip(np.searchsorted(history.frame, frame, side="right") - 1, 0, last))
    agents, after = history.agents, min(row + 1, last)
    frames = float(history.frame[after] - history.frame[row])
    alive = agents.health[row] > 0
    share = 0.0 if frames == 0.0 else min(1.0, (frame - float(history.frame[row])) / frames)
    way = agents.position[after] - agents.position[row]
    is_walk = np.sqrt((way * way).sum(axis=1)) <= FASTEST * frames / FRAMES_PER_SECOND
    moves = alive & (agents.health[after] > 0) & is_walk
    part = np.where(moves, share, 0.0)
    turn = (agents.yaw[after] - agents.yaw[row] + 180.0) % 360.0 - 180.0
    return InterpolatedState(
        frame,
        row,
        agents.position[row] + part[:, None] * way,
        agents.yaw[row] + part * turn,
        agents.pitch[row] + part * (agents.pitch[after] - agents.pitch[row]),
        alive,
    )


def boxes_at(history: History, row: int) -> Boxes:
    """Return the supply boxes that are present after a step."""
    rows = [boxes.row for boxes in history.boxes]
    return history.boxes[int(np.searchsorted(rows, row, side="right")) - 1]


def objects_at(history: History, moment: InterpolatedState) -> DynamicObjects:
    """Return the agents and supply boxes of a moment, as images show them."""
    boxes, seats = boxes_at(history, moment.row), len(moment.yaw)
    state = allocate_state(1, seats, len(boxes.serial))
    agents, row = state.agents, moment.row
    agents.present[0], agents.health[0] = history.agents.present[row], history.agents.health[row]
    agents.team[0], agents.invincible_left[0] = history.teams, history.agents.invincible_left[row]
    agents.position[0], agents.yaw[0] = moment.position, moment.yaw
    state.supplies.position[0], state.supplies.quantity[0] = boxes.position, boxes.quantity
    state.supplies.serial[0] = boxes.serial
    return dynamic_objects_in(state)
