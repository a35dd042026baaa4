"""The action mode ``box``: numbers in [-1, 1]."""

from typing import Any

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import ArrayLike, NDArray

from wildscav_engine.arithmetic.elementary_functions import arctangent
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.envs.spaces.action_mode import (
    DIRECTION,
    LOOK,
    SPEED,
    TURN,
    ActionError,
    ActionMode,
    Axes,
    Rows,
    Yaws,
    as_array,
)
from wildscav_engine.sensors.base import Column
from wildscav_engine.specs.actions import MAX_WALK_SPEED

TURN_STEP, LOOK_STEP = 45.0, 20.0  # degrees per step, for 1 in the mode box


class BoxMode(ActionMode):
    """The mode ``box``: numbers in [-1, 1]."""

    @property
    def space(self) -> Box:
        """(k,) in [-1, 1]: walk east, walk north, turn, look, jump and the other flags."""
        return Box(-1.0, 1.0, (len(self.fields),), np.float32)

    @property
    def columns(self) -> tuple[Column, ...]:
        """The numbers, in order."""
        return (
            Column("walk east", "", -1.0, 1.0, f"with walk north: a length of 1 is {MAX_WALK_SPEED:g} m/s"),
            Column("walk north", "", -1.0, 1.0, f"with walk east: a length of 1 is {MAX_WALK_SPEED:g} m/s"),
            Column("turn", "", -1.0, 1.0, f"1 turns right by {TURN_STEP:g}° in the step"),
            Column("look", "", -1.0, 1.0, f"1 looks down by {LOOK_STEP:g}° in the step"),
            *self._flag_columns("", -1.0, "above 0"),
        )

    def describe(self) -> dict[str, Any]:
        """Return the meaning of 1 in m/s and in degrees per frame, and the names of the flags."""
        return {
            "mode": "box",
            "walk_speed": MAX_WALK_SPEED,
            "turn": TURN_STEP / self.frames,
            "look": LOOK_STEP / self.frames,
            "flags": self._flag_names(),
        }

    def decode(self, actions: ArrayLike, yaws: Yaws, rows: Rows, axes: Axes) -> None:  # noqa: ARG002
        """Write (*axes, k) numbers."""
        values = as_array(actions, axes, (len(self.fields),), np.float64)
        if not _decode_box(values, self.flags, TURN_STEP / self.frames, LOOK_STEP / self.frames, rows):
            bad = values[~(np.abs(values) <= 1.0)][0]
            raise ActionError(f"actions: {bad:g}, must be in [-1, 1]")


@kernel
def _decode_box(
    values: NDArray[np.float64], flags: NDArray[np.int64], turn: float, look: float, rows: Rows
) -> bool:
    """Write (N, FIELDS) rows from (N, k) numbers; return False if one is not in [-1, 1]."""
    for row in range(values.shape[0]):
        for place in range(values.shape[1]):
            if not -1.0 <= values[row, place] <= 1.0:
                return False
        east, north = values[row, 0], values[row, 1]
        rows[row, DIRECTION] = arctangent(east, north)
        rows[row, SPEED] = MAX_WALK_SPEED * min(1.0, np.sqrt(east * east + north * north))
        rows[row, TURN] = turn * values[row, 2]
        rows[row, LOOK] = look * values[row, 3]
        for place in range(flags.shape[0]):
            rows[row, flags[place]] = 1.0 if values[row, 4 + place] > 0.0 else 0.0
    return True
