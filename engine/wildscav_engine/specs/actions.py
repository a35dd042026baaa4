"""The action of one agent for one step, as a row of numbers, and the table of what they mean."""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

MAX_WALK_SPEED = 10.0  # m/s
TURN_LIMIT, LOOK_LIMIT = 180.0, 90.0  # degrees per frame, in the action mode dict


class Field(IntEnum):
    """The columns of an action row, float32. All zeros mean "no action": stand still and keep everything.

    Angles may have any finite value. The fields after LOOK are flags, 0 or 1.
    """

    WALK_DIRECTION = 0
    WALK_SPEED = 1
    TURN = 2
    LOOK = 3
    JUMP = 4
    PICK_UP = 5
    SHOOT = 6
    RELOAD = 7


class Meaning(NamedTuple):
    """What a field of an action means, and the range of its values in the action mode dict."""

    unit: str
    low: float
    high: float
    meaning: str


def _flag(meaning: str) -> Meaning:
    return Meaning("0 or 1", 0.0, 1.0, meaning)


MEANINGS: dict[Field, Meaning] = {
    Field.WALK_DIRECTION: Meaning("degrees", 0.0, 360.0, "direction to walk in: 0 is north, 90 is east"),
    Field.WALK_SPEED: Meaning("m/s", 0.0, MAX_WALK_SPEED, "speed to walk at"),
    Field.TURN: Meaning(
        "degrees per frame",
        -TURN_LIMIT,
        TURN_LIMIT,
        "added to the yaw in each frame of the step; positive turns right",
    ),
    Field.LOOK: Meaning(
        "degrees per frame",
        -LOOK_LIMIT,
        LOOK_LIMIT,
        "added to the pitch in each frame of the step; positive looks down",
    ),
    Field.JUMP: _flag("jump, as soon as the agent stands on something"),
    Field.PICK_UP: _flag("pick up the supply boxes within reach"),
    Field.SHOOT: _flag("shoot along the view"),
    Field.RELOAD: _flag("reload the weapon from the spare ammunition"),
}
FIELDS = len(Field)


def no_actions(seats: int) -> NDArray[np.float32]:
    """Return (seats, FIELDS) rows that do nothing."""
    return np.zeros((seats, FIELDS), np.float32)
