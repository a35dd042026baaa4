"""The action mode ``keys``: the keys and the mouse of a person, by the law of ``wildscav.policy.keys``."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Box, Dict, Discrete
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import arctangent, wrap
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.envs.spaces.action_mode import (
    DIRECTION,
    LOOK,
    SPEED,
    TURN,
    VALID,
    ActionError,
    ActionMode,
    Axes,
    Rows,
    Yaws,
    choice_mask,
    named_values,
)
from wildscav_engine.sensors.base import Column
from wildscav_engine.specs.actions import MAX_WALK_SPEED, Field
from wildscav_engine.specs.rules import AT_ONCE, FRAMES_PER_SECOND

COUNTS_PER_DEGREE = 50
MOST_COUNTS = 9000  # in a step: half a turn
WALKS = ("forward", "back", "left", "right")
MOUSE = ("mouse_x", "mouse_y")
FIRST_MOUSE, FIRST_FLAG = 4, 6  # their places behind the keys to walk
SIGNS = (0, 1, -1)  # of a walk along an axis


class KeysMode(ActionMode):
    """The mode ``keys``: which keys are held in a step, and how far the mouse moves."""

    def __init__(self, fields: Sequence[Field], frames_per_action: int, turn_speed: float = AT_ONCE) -> None:
        super().__init__(fields, frames_per_action)
        self.names = (*WALKS, *MOUSE, *self._flag_names())
        self.most = min(MOST_COUNTS, int(turn_speed * self.frames * COUNTS_PER_DEGREE / FRAMES_PER_SECOND))

    @property
    def space(self) -> Dict:
        """A Dict by the names of the keys, and the two axes of the mouse."""
        return Dict({name: _space_of(name) for name in self.names})

    @property
    def columns(self) -> tuple[Column, ...]:
        """The keys, sorted by name, as Gymnasium sorts them."""
        walks = (Column(name, "0 or 1", 0, 1, f"1: walk {name}, relative to the view") for name in WALKS)
        mouse = (
            Column(name, "counts", -MOST_COUNTS, MOST_COUNTS, f"{COUNTS_PER_DEGREE} turn 1° {way}")
            for name, way in zip(MOUSE, ("to the right", "down"), strict=True)
        )
        columns = (*walks, *mouse, *self._flag_columns("0 or 1", 0.0, "1"))
        return tuple(sorted(columns, key=lambda column: column.name))

    def describe(self) -> dict[str, Any]:
        """Return the names of the flags, the counts that a body turns at most, and the frames of a step."""
        return {"mode": "keys", "flags": self._flag_names(), "most": self.most, "frames": self.frames}

    def decode(self, actions: Any, yaws: Yaws, rows: Rows, axes: Axes) -> None:
        """Write the rows of (*axes,) numbers of each key."""
        values = named_values(actions, self.names, axes)
        wrong = _decode_keys(values, self.flags, yaws, self.most, self.frames, rows)
        if wrong != VALID:
            name = self.names[wrong // values.shape[1]]
            allowed = f"in [-{MOST_COUNTS}, {MOST_COUNTS}]" if name in MOUSE else "0 or 1"
            raise ActionError(f"{name}: {values.flat[wrong]:g}, must be {allowed}")

    def mask(self, alive: bool) -> dict[str, Any]:
        """Return the masks of the keys, None for the mouse."""
        return {name: None if name in MOUSE else choice_mask(2, alive) for name in self.names}

    def recover(self, rows: Rows, yaws: Yaws) -> dict[str, NDArray[Any]]:
        """Return the keys by which agents played (N, FIELDS) rows; ActionError if none give a row.

        Two keys that cancel each other count as not held.
        """
        keys = np.zeros((len(self.names), len(rows)))
        turns = rows[:, [TURN, LOOK]].T.astype(np.float64) * (self.frames * COUNTS_PER_DEGREE)
        keys[FIRST_MOUSE:FIRST_FLAG] = np.rint(turns).clip(-self.most, self.most)
        keys[FIRST_FLAG:] = rows[:, self.flags].T
        found, again = np.zeros(len(rows), np.bool_), np.zeros_like(rows)
        for along in SIGNS:
            for aside in SIGNS:
                walk = np.array([[along == 1], [along == -1], [aside == -1], [aside == 1]])
                keys[:FIRST_MOUSE, ~found] = walk
                _decode_keys(keys, self.flags, yaws, self.most, self.frames, again)
                found |= (again == rows).all(axis=1)
        if not found.all():
            raise ActionError(
                "the agent did not play by keys: no keys and no movement of a mouse do the same"
            )
        return {
            name: column.astype(np.float32 if name in MOUSE else np.int64)
            for name, column in zip(self.names, keys, strict=True)
        }


def _space_of(name: str) -> Box | Discrete:
    return Box(-MOST_COUNTS, MOST_COUNTS, (), np.float32) if name in MOUSE else Discrete(2)


@kernel
def _decode_keys(
    values: NDArray[np.float64],
    flags: NDArray[np.int64],
    yaws: NDArray[np.float64],
    most: int,
    frames: int,
    rows: Rows,
) -> int:
    """Write (N, FIELDS) rows from (6 + flags, N) numbers; return the first one not allowed, or VALID."""
    for place in range(values.shape[0]):
        is_mouse = FIRST_MOUSE <= place < FIRST_FLAG
        for row in range(values.shape[1]):
            value = values[place, row]
            if not (abs(value) <= MOST_COUNTS if is_mouse else value in (0.0, 1.0)):
                return int(place * values.shape[1] + row)
    for row in range(values.shape[1]):
        forward, right = values[0, row] - values[1, row], values[3, row] - values[2, row]
        turned, looked = _degrees(values[4, row], most), _degrees(values[5, row], most)
        walks = forward != 0.0 or right != 0.0
        rows[row, DIRECTION] = wrap(yaws[row] + turned + arctangent(right, forward)) if walks else 0.0
        rows[row, SPEED] = MAX_WALK_SPEED if walks else 0.0
        rows[row, TURN], rows[row, LOOK] = turned / frames, looked / frames
        for place in range(flags.shape[0]):
            rows[row, flags[place]] = values[FIRST_FLAG + place, row]
    return VALID


@kernel
def _degrees(counts: float, most: int) -> float:
    """Return the degrees of some counts of a mouse, rounded to whole ones; never -0."""
    return float(min(most, max(-most, np.rint(counts) + 0.0))) / COUNTS_PER_DEGREE
