"""The action modes, which convert the actions of learners to the rows of numbers that the engine plays.

- ``dict``: the paper's action space, by the names of the fields of ``actions.Field``.
- ``box``: numbers in [-1, 1]: walk east and walk north (length 1 is full speed), turn and look (1 is
  45 and 20 degrees per step), then jump and the track's other flags, which are set above 0.
- ``baseline``: one number, as in the public baselines: a compass direction, a speed, and whether to pick up.
- ``multidiscrete``: a few choices per field; directions are clockwise from the view.
- ``fine``: the same with more turns and looks, for aiming.
- ``keys``: the keys and the mouse of a person.
"""

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from gymnasium.spaces import Box, Dict, Discrete, MultiDiscrete, Space
from numpy.typing import ArrayLike, NDArray

from wildscav_engine.arithmetic.elementary_functions import arctangent
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.spaces.action_mode import (
    DIRECTION,
    FLOATS,
    LOOK,
    SPEED,
    TURN,
    VALID,
    WHOLE,
    ActionError,
    ActionMode,
    Axes,
    Rows,
    Yaws,
    as_array,
    choice_mask,
    named_values,
)
from wildscav_engine.envs.spaces.keys import KeysMode
from wildscav_engine.sensors.base import Column
from wildscav_engine.specs.actions import FIELDS, MAX_WALK_SPEED, MEANINGS, Field

__all__ = ["MODES", "ActionError", "ActionMode", "action_mode"]

DIRECTIONS = 8  # in the mode baseline with pick-up, and in multidiscrete
WALKS = ("stand", *(f"{45 * place}°" for place in range(DIRECTIONS)))
WALK_SPEEDS = (5.0, 10.0)  # m/s
TURNS = (-45.0, -15.0, -5.0, 0.0, 5.0, 15.0, 45.0)  # degrees per step
LOOKS = (-20.0, -5.0, 0.0, 5.0, 20.0)  # degrees per step
# Of the mode fine: each is 1.6 to 2 times the one before, so that an aim is as good near as far, relatively.
_FINE_TURNS = (0.5, 1.0, 2.0, 3.5, 6.0, 10.0, 17.0, 30.0, 60.0, 120.0)
_FINE_LOOKS = (0.5, 1.0, 2.0, 4.0, 8.0, 16.0)
FINE_TURNS = (*(-turn for turn in reversed(_FINE_TURNS)), 0.0, *_FINE_TURNS)  # degrees per step
FINE_LOOKS = (*(-look for look in reversed(_FINE_LOOKS)), 0.0, *_FINE_LOOKS)  # degrees per step
TURN_STEP, LOOK_STEP = 45.0, 20.0  # degrees per step, for 1 in the mode box
SPEEDS = int(MAX_WALK_SPEED) + 1  # whole numbers of m/s, in the mode dict; records play fractions, too


class DictMode(ActionMode):
    """The mode ``dict``: the paper's fields."""

    def __init__(self, fields: Sequence[Field], frames_per_action: int) -> None:
        super().__init__(fields, frames_per_action)
        self._names = [field.name.lower() for field in self.fields]
        self._columns = np.array(self.fields, np.int64)
        self._ranges = np.array([_range(field) for field in self.fields])

    @property
    def space(self) -> Dict:
        """A Dict by the names of the fields, in lower case."""
        return Dict({field.name.lower(): _space_of(field) for field in self.fields})

    @property
    def columns(self) -> tuple[Column, ...]:
        """The fields, sorted by name, as Gymnasium sorts them."""
        fields = sorted(self.fields, key=lambda field: field.name)
        return tuple(Column(field.name.lower(), *MEANINGS[field]) for field in fields)

    def describe(self) -> dict[str, Any]:
        """Return the names of the fields."""
        return {"mode": "dict", "fields": self._names}

    def decode(self, actions: Any, yaws: Yaws, rows: Rows, axes: Axes) -> None:  # noqa: ARG002
        """Write (*axes,) numbers of each field into its column."""
        values = named_values(actions, self._names, axes)
        rows[:] = 0.0
        wrong = _write_rows(values, self._columns, self._ranges, rows)
        if wrong != VALID:
            field = self.fields[wrong // values.shape[1]]
            raise ActionError(f"{field.name.lower()}: {values.flat[wrong]:g}, must be {_allowed(field)}")

    def mask(self, alive: bool) -> dict[str, Any]:
        """Return the masks of the fields that are choices, None for the others."""
        return {
            field.name.lower(): choice_mask(_choices(field), alive) if _choices(field) else None
            for field in self.fields
        }


def _range(field: Field) -> tuple[float, float]:
    return MEANINGS[field].low, MEANINGS[field].high


def _choices(field: Field) -> int:
    """Return the number of choices of a field in the mode ``dict``; 0 for continuous fields."""
    if field == Field.WALK_SPEED:
        return SPEEDS
    return 2 if field > Field.LOOK else 0


def _space_of(field: Field) -> Space[Any]:
    choices = _choices(field)
    return Discrete(choices) if choices else Box(*_range(field), (), np.float32)


def _allowed(field: Field) -> str:
    if field > Field.LOOK:
        return "0 or 1"
    low, high = _range(field)
    return f"from 0 to {high:g}" if field == Field.WALK_SPEED else f"in [{low:g}, {high:g}]"


@kernel
def _write_rows(
    values: NDArray[np.float64], columns: NDArray[np.int64], ranges: NDArray[np.float64], rows: Rows
) -> int:
    """Write (F, N) numbers into the columns of their fields; return the first one not allowed, or VALID."""
    for place in range(values.shape[0]):
        field, low, high = columns[place], ranges[place, 0], ranges[place, 1]
        for row in range(values.shape[1]):
            value = values[place, row]
            if not low <= value <= high or (field > LOOK and 0.0 < value < 1.0):
                return int(place * values.shape[1] + row)
            rows[row, field] = value
    return VALID


class BoxMode(ActionMode):
    """The mode ``box``: numbers in [-1, 1]."""

    def __init__(self, fields: Sequence[Field], frames_per_action: int) -> None:
        super().__init__(fields, frames_per_action)
        self._shape = (len(self.fields),)
        self._turn, self._look = TURN_STEP / self.frames, LOOK_STEP / self.frames  # degrees per frame

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
            "turn": self._turn,
            "look": self._look,
            "flags": self._flag_names(),
        }

    def decode(self, actions: ArrayLike, yaws: Yaws, rows: Rows, axes: Axes) -> None:  # noqa: ARG002
        """Write (*axes, k) numbers."""
        values = as_array(actions, axes, self._shape, FLOATS)
        if not _decode_box(values, self.flags, self._turn, self._look, rows):
            bad = values[~(np.abs(values) <= 1.0)][0]
            raise ActionError(f"actions: {bad:g}, must be in [-1, 1]")


@kernel
def _decode_box(values: NDArray[Any], flags: NDArray[np.int64], turn: float, look: float, rows: Rows) -> bool:
    """Write (N, FIELDS) rows from (N, k) numbers; return False if one is not in [-1, 1]."""
    for row in range(values.shape[0]):
        for place in range(values.shape[1]):
            if not -1.0 <= values[row, place] <= 1.0:
                return False
        east, north = np.float64(values[row, 0]), np.float64(values[row, 1])
        rows[row, DIRECTION] = arctangent(east, north)
        rows[row, SPEED] = MAX_WALK_SPEED * min(1.0, np.sqrt(east * east + north * north))
        rows[row, TURN] = turn * values[row, 2]
        rows[row, LOOK] = look * values[row, 3]
        for place in range(flags.shape[0]):
            rows[row, flags[place]] = 1.0 if values[row, 4 + place] > 0.0 else 0.0
    return True


class BaselineMode(ActionMode):
    """The mode ``baseline``: the choices of the public baselines."""

    def __init__(self, fields: Sequence[Field], frames_per_action: int) -> None:
        super().__init__(fields, frames_per_action)
        self._picks_up = picks_up = Field.PICK_UP in self.fields
        directions = np.arange(DIRECTIONS) * 45.0 if picks_up else np.arange(4) * 90.0
        speeds = (3.0, 6.0, 9.0) if picks_up else (3.0, 6.0)
        rows = []
        for direction in directions:
            for speed in speeds:
                for pick_up in (0.0, 1.0) if picks_up else (0.0,):
                    row = np.zeros(FIELDS, np.float32)
                    row[Field.WALK_DIRECTION], row[Field.WALK_SPEED] = direction, speed
                    row[Field.PICK_UP] = pick_up
                    rows.append(row)
        self.table = np.array(rows)  # (choices, FIELDS)

    @property
    def space(self) -> Discrete:
        """One of 8 choices, or of 48 in tracks with pick-up."""
        return Discrete(len(self.table))

    @property
    def columns(self) -> tuple[Column, ...]:
        """The one choice."""
        chosen = "direction and speed, and whether to pick up" if self._picks_up else "direction and speed"
        return (
            Column("choice", "", 0.0, len(self.table) - 1.0, f"walk: {chosen}, from the list of choices"),
        )

    def describe(self) -> dict[str, Any]:
        """Return the table of action rows."""
        return {"mode": "baseline", "table": self.table.tolist()}

    def decode(self, actions: ArrayLike, yaws: Yaws, rows: Rows, axes: Axes) -> None:  # noqa: ARG002
        """Write the rows of (*axes,) choices."""
        choices = as_array(actions, axes, (), WHOLE)
        if not _look_up(choices, self.table, rows):
            wrong = choices[(choices < 0) | (choices >= len(self.table))][0]
            raise ActionError(f"actions: {wrong}, must be from 0 to {len(self.table) - 1}")

    def mask(self, alive: bool) -> NDArray[np.int8]:
        """Return (choices,) 1 for choices that may be sampled."""
        return choice_mask(len(self.table), alive)


@kernel
def _look_up(choices: NDArray[np.int64], table: NDArray[np.float32], rows: Rows) -> bool:
    """Write the rows of (N,) choices; return False if there is no such choice."""
    for row in range(choices.shape[0]):
        if not 0 <= choices[row] < table.shape[0]:
            return False
        for field in range(table.shape[1]):
            rows[row, field] = table[choices[row], field]
    return True


class MultiDiscreteMode(ActionMode):
    """The mode ``multidiscrete``: a few choices per field."""

    name: ClassVar[str] = "multidiscrete"
    turns: ClassVar[tuple[float, ...]] = TURNS
    looks: ClassVar[tuple[float, ...]] = LOOKS

    def __init__(self, fields: Sequence[Field], frames_per_action: int) -> None:
        super().__init__(fields, frames_per_action)
        self.sizes = np.array(
            [len(WALKS), len(WALK_SPEEDS), len(self.turns), len(self.looks), *[2] * len(self.flags)], np.int64
        )
        self._speeds = np.array(WALK_SPEEDS)
        self._turns, self._looks = np.array(self.turns) / self.frames, np.array(self.looks) / self.frames

    @property
    def space(self) -> MultiDiscrete:
        """Walk (stand, or 8 directions clockwise from the view), speed, turn, look, jump and other flags."""
        return MultiDiscrete(self.sizes)

    @property
    def columns(self) -> tuple[Column, ...]:
        """The choices, in order."""
        speeds, turns, looks = (_listed(numbers) for numbers in (WALK_SPEEDS, self.turns, self.looks))
        walk = "0 stands still; 1 to 8 walk 0, 45, … 315° clockwise from the view"
        return (
            Column("walk", "", 0.0, len(WALKS) - 1.0, walk),
            Column("speed", "", 0.0, len(WALK_SPEEDS) - 1.0, f"walk at {speeds} m/s"),
            Column(
                "turn", "", 0.0, len(self.turns) - 1.0, f"turn by {turns}° in the step; positive is right"
            ),
            Column("look", "", 0.0, len(self.looks) - 1.0, f"look by {looks}° in the step; positive is down"),
            *self._flag_columns("", 0.0, "1"),
        )

    def describe(self) -> dict[str, Any]:
        """Return the choices: degrees clockwise from the view (None: stand), m/s, and degrees per frame."""
        return {
            "mode": self.name,
            "directions": [None, *(45.0 * place for place in range(DIRECTIONS))],
            "speeds": self._speeds.tolist(),
            "turns": self._turns.tolist(),
            "looks": self._looks.tolist(),
            "flags": self._flag_names(),
        }

    def decode(self, actions: ArrayLike, yaws: Yaws, rows: Rows, axes: Axes) -> None:
        """Write the rows of (*axes, k) choices."""
        choices = as_array(actions, axes, (len(self.sizes),), WHOLE)
        if not _decode_choices(
            choices, self.sizes, self.flags, self._speeds, self._turns, self._looks, yaws, rows
        ):
            wrong = choices[((choices < 0) | (choices >= self.sizes)).any(axis=1)][0]
            raise ActionError(f"actions: {wrong.tolist()}, must be from 0 to {(self.sizes - 1).tolist()}")

    def mask(self, alive: bool) -> tuple[NDArray[np.int8], ...]:
        """Return a mask for each field."""
        return tuple(choice_mask(int(size), alive) for size in self.sizes)


class FineMode(MultiDiscreteMode):
    """The mode ``fine``: ``multidiscrete`` with more turns and looks, from half a degree on."""

    name: ClassVar[str] = "fine"
    turns: ClassVar[tuple[float, ...]] = FINE_TURNS
    looks: ClassVar[tuple[float, ...]] = FINE_LOOKS


def _listed(numbers: Sequence[float]) -> str:
    return ", ".join(f"{number:g}" for number in numbers[:-1]) + f" or {numbers[-1]:g}"


@kernel
def _decode_choices(
    choices: NDArray[np.int64],
    sizes: NDArray[np.int64],
    flags: NDArray[np.int64],
    speeds: NDArray[np.float64],
    turns: NDArray[np.float64],
    looks: NDArray[np.float64],
    yaws: NDArray[np.float64],
    rows: Rows,
) -> bool:
    """Write (N, FIELDS) rows from (N, k) choices; return False if there is no such choice."""
    for row in range(choices.shape[0]):
        choice = choices[row]
        for place in range(sizes.shape[0]):
            if not 0 <= choice[place] < sizes[place]:
                return False
        walks = choice[0] > 0
        rows[row, DIRECTION] = yaws[row] + 45.0 * (choice[0] - 1) if walks else 0.0
        rows[row, SPEED] = speeds[choice[1]] if walks else 0.0
        rows[row, TURN], rows[row, LOOK] = turns[choice[2]], looks[choice[3]]
        for place in range(flags.shape[0]):
            rows[row, flags[place]] = choice[4 + place]
    return True


MODES: dict[str, type[ActionMode]] = {
    "dict": DictMode,
    "box": BoxMode,
    "baseline": BaselineMode,
    "multidiscrete": MultiDiscreteMode,
    "fine": FineMode,
    "keys": KeysMode,
}


def action_mode(config: EnvConfig) -> ActionMode:
    """Return the action mode of an environment."""
    if config.action_mode == "keys":
        return KeysMode(config.fields, config.frames_per_action, config.rules.turn_speed)
    return MODES[config.action_mode](config.fields, config.frames_per_action)
