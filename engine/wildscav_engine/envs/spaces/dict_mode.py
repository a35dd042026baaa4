"""The action mode ``dict``: the paper's action space, by the names of the fields."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Box, Dict, Discrete, Space
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.envs.spaces.action_mode import (
    DIRECTION,
    LOOK,
    MEANINGS,
    SPEED,
    TURN,
    ActionError,
    ActionMode,
    Rows,
    choice_mask,
)
from wildscav_engine.sensors.base import Column
from wildscav_engine.specs.actions import MAX_WALK_SPEED, Field

TURN_LIMIT, LOOK_LIMIT = 180.0, 90.0  # degrees per frame, in the mode dict
SPEEDS = int(MAX_WALK_SPEED) + 1  # whole numbers of m/s, in the mode dict
VALID = -1


class DictMode(ActionMode):
    """The mode ``dict``: the paper's fields."""

    def __init__(self, fields: Sequence[Field], frames_per_action: int) -> None:
        super().__init__(fields, frames_per_action)
        self._names = {field.name.lower(): int(field) for field in self.fields}

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

    def decode(self, actions: Any, yaws: NDArray[np.float64], rows: Rows) -> None:  # noqa: ARG002
        """Write (N,) numbers of each field into its column."""
        rows[:] = 0.0
        self._fill(actions, rows)

    def decode_one(self, action: Any, yaws: NDArray[np.float64], rows: Rows) -> None:  # noqa: ARG002
        """Write one number of each field, which may be an array with one element."""
        self._fill(action, rows)

    def _fill(self, actions: Any, rows: Rows) -> None:
        names = self._names
        if not isinstance(actions, Mapping) or len(actions) != len(names):
            raise ActionError(f"action is {actions!r}, must be a mapping of {', '.join(names)}")
        columns = rows.T
        try:
            for name, column in names.items():
                columns[column] = actions[name]
        except KeyError as error:
            raise ActionError(f"action has no {error}; its fields are {', '.join(names)}") from None
        except (TypeError, ValueError):
            raise ActionError(
                f"action: {name} is {actions[name]!r}, must be one number per learner"
            ) from None
        wrong = _check_rows(rows)
        if wrong != VALID:
            field = Field(wrong)
            value = actions[field.name.lower()]
            raise ActionError(f"action: {field.name.lower()} is {value}, must be {_allowed(field)}")

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
def _check_rows(rows: Rows) -> int:
    """Return the first field of (N, FIELDS) that is outside its range, or VALID."""
    for row in range(rows.shape[0]):
        for field in range(rows.shape[1]):
            value = rows[row, field]
            low, high = 0.0, 1.0
            if field == DIRECTION:
                low, high = 0.0, 360.0
            elif field == SPEED:
                low, high = 0.0, MAX_WALK_SPEED
            elif field == TURN:
                low, high = -TURN_LIMIT, TURN_LIMIT
            elif field == LOOK:
                low, high = -LOOK_LIMIT, LOOK_LIMIT
            if not low <= value <= high:
                return field
    return VALID
