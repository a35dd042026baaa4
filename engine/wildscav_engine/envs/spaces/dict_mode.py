"""The action mode ``dict``: the paper's action space, by the names of the fields."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Box, Dict, Discrete, Space
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.envs.spaces.action_mode import (
    DIRECTION,
    LOOK,
    MEANINGS,
    NUMBERS,
    SPEED,
    TURN,
    ActionError,
    ActionMode,
    Axes,
    Rows,
    Yaws,
    as_array,
    check_names,
    choice_mask,
)
from wildscav_engine.sensors.base import Column
from wildscav_engine.specs.actions import MAX_WALK_SPEED, Field

TURN_LIMIT, LOOK_LIMIT = 180.0, 90.0  # degrees per frame, in the mode dict
SPEEDS = int(MAX_WALK_SPEED) + 1  # whole numbers of m/s, in the mode dict; records play fractions, too
VALID = -1


class DictMode(ActionMode):
    """The mode ``dict``: the paper's fields."""

    def __init__(self, fields: Sequence[Field], frames_per_action: int) -> None:
        super().__init__(fields, frames_per_action)
        self._names = {field.name.lower(): int(field) for field in self.fields}
        self._columns = np.array(self.fields, np.int64)

    @property
    def space(self) -> Dict:
        """A Dict by the names of the fields, in lower case."""
        return Dict({field.name.lower(): _space_of(field) for field in self.fields})

    @property
    def columns(self) -> tuple[Column, ...]:
        """The fields, sorted by name, as Gymnasium sorts them."""
        fields = sorted(self.fields, key=lambda field: field.name)
        return tuple(
            Column(field.name.lower(), MEANINGS[field][0], *_bounds(field), MEANINGS[field][1])
            for field in fields
        )

    def describe(self) -> dict[str, Any]:
        """Return the names of the fields."""
        return {"mode": "dict", "fields": list(self._names)}

    def decode(self, actions: Any, yaws: Yaws, rows: Rows, axes: Axes) -> None:  # noqa: ARG002
        """Write (*axes,) numbers of each field into its column."""
        names = self._names
        check_names(actions, names)
        try:
            values = np.array([actions[name] for name in names])
        except ValueError:  # of different shapes
            values = np.empty(0)
        if values.shape != (len(names), *axes) or values.dtype.kind not in NUMBERS:
            values = np.array([as_array(actions[name], axes, (), np.float64, name) for name in names])
        rows[:] = 0.0
        values = np.ascontiguousarray(values, np.float64).reshape(len(names), -1)
        wrong = _write_rows(values, self._columns, rows)
        if wrong != VALID:
            field = self.fields[wrong // values.shape[1]]
            raise ActionError(f"{field.name.lower()}: {values.flat[wrong]:g}, must be {_allowed(field)}")

    def mask(self, alive: bool) -> dict[str, Any]:
        """Return the masks of the fields that are choices, None for the others."""
        return {
            field.name.lower(): choice_mask(_choices(field), alive) if _choices(field) else None
            for field in self.fields
        }


def _choices(field: Field) -> int:
    """Return the number of choices of a field in the mode ``dict``; 0 for continuous fields."""
    if field == Field.WALK_SPEED:
        return SPEEDS
    return 2 if field > Field.LOOK else 0


def _space_of(field: Field) -> Space[Any]:
    if choices := _choices(field):
        return Discrete(choices)
    low, high = _range(field)
    return Box(low, high, (), np.float32)


def _bounds(field: Field) -> tuple[float, float]:
    """Return the least and the greatest value of a field in the mode ``dict``."""
    choices = _choices(field)
    return (0.0, choices - 1.0) if choices else _range(field)


def _range(field: Field) -> tuple[float, float]:
    if field == Field.WALK_DIRECTION:
        return 0.0, 360.0
    limit = TURN_LIMIT if field == Field.TURN else LOOK_LIMIT
    return -limit, limit


def _allowed(field: Field) -> str:
    if field > Field.LOOK:
        return "0 or 1"
    if field == Field.WALK_SPEED:
        return f"from 0 to {MAX_WALK_SPEED:g}"
    return "in [{:g}, {:g}]".format(*_range(field))


@kernel
def _write_rows(values: NDArray[np.float64], columns: NDArray[np.int64], rows: Rows) -> int:
    """Write (F, N) numbers into the columns of their fields; return the first one not allowed, or VALID."""
    for place in range(values.shape[0]):
        field = columns[place]
        low, high = 0.0, 1.0
        if field == DIRECTION:
            low, high = 0.0, 360.0
        elif field == SPEED:
            low, high = 0.0, MAX_WALK_SPEED
        elif field == TURN:
            low, high = -TURN_LIMIT, TURN_LIMIT
        elif field == LOOK:
            low, high = -LOOK_LIMIT, LOOK_LIMIT
        for row in range(values.shape[1]):
            value = values[place, row]
            if not low <= value <= high or (field > LOOK and 0.0 < value < 1.0):
                return int(place * values.shape[1] + row)
            rows[row, field] = value
    return VALID
