"""The action of one agent for one step, as a row of eight numbers."""

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray


class Field(IntEnum):
    """The columns of an action row, float32. All zeros mean "no action": stand still and keep everything."""

    WALK_DIRECTION = 0  # degrees, compass: 0 is +z (north), 90 is +x (east); any finite value
    WALK_SPEED = 1  # m/s, 0–10
    TURN = 2  # degrees per frame, added to the yaw; positive turns right
    LOOK = 3  # degrees per frame, added to the pitch; positive looks down
    JUMP = 4  # 0 or 1
    PICK_UP = 5  # 0 or 1
    SHOOT = 6  # 0 or 1
    RELOAD = 7  # 0 or 1


FIELDS = len(Field)
MAX_WALK_SPEED = 10.0  # m/s


def no_actions(seats: int) -> NDArray[np.float32]:
    """Return (seats, FIELDS) rows that do nothing."""
    return np.zeros((seats, FIELDS), np.float32)
