"""The action modes, which convert the actions of learners to the rows of numbers that the engine plays.

- ``dict``: the paper's action space, by the names of the fields of ``actions.Field``.
- ``box``: numbers in [-1, 1]: walk east and walk north (length 1 is full speed), turn and look (1 is
  TURN_STEP and LOOK_STEP degrees per step), then jump and the track's other flags, which are set above 0.
- ``baseline``: one number, as in the public baselines: a compass direction, a speed, and whether to pick up.
- ``multidiscrete``: a few choices per field; directions are clockwise from the view.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Box, Dict, Discrete, MultiDiscrete, Space
from numpy.typing import ArrayLike, NDArray

from wildscav_engine.arithmetic.elementary_functions import arctangent
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.sensors.base import Column
from wildscav_engine.specs.actions import FIELDS, MAX_WALK_SPEED, Field

Rows = NDArray[np.float32]  # (N, FIELDS), written

TURN_STEP, LOOK_STEP = 45.0, 20.0  # degrees per step, for 1 in the mode box
TURN_LIMIT, LOOK_LIMIT = 180.0, 90.0  # degrees per frame, in the mode dict
SPEEDS = int(MAX_WALK_SPEED) + 1  # whole numbers of m/s, in the mode dict
DIRECTIONS = 8  # in the mode baseline with pick-up, and in multidiscrete
WALKS = ("stand", *(f"{45 * place}°" for place in range(DIRECTIONS)))
WALK_SPEEDS = (5.0, 10.0)  # m/s
TURNS = (-45.0, -15.0, -5.0, 0.0, 5.0, 15.0, 45.0)  # degrees per step
LOOKS = (-20.0, -5.0, 0.0, 5.0, 20.0)  # degrees per step

_DIRECTION, _SPEED = int(Field.WALK_DIRECTION), int(Field.WALK_SPEED)
_TURN, _LOOK, _JUMP = int(Field.TURN), int(Field.LOOK), int(Field.JUMP)
VALID = -1

# The unit of each field, and what it does.
MEANINGS: dict[Field, tuple[str, str]] = {
    Field.WALK_DIRECTION: ("degrees", "direction to walk in: 0 is north, 90 is east"),
    Field.WALK_SPEED: ("m/s", "speed to walk at"),
    Field.TURN: ("degrees per frame", "added to the yaw in each frame of the step; positive turns right"),
    Field.LOOK: ("degrees per frame", "added to the pitch in each frame of the step; positive looks down"),
    Field.JUMP: ("0 or 1", "jump, as soon as the agent stands on something"),
    Field.PICK_UP: ("0 or 1", "pick up the supply boxes within reach"),
    Field.SHOOT: ("0 or 1", "shoot along the view"),
    Field.RELOAD: ("0 or 1", "reload the weapon from the spare ammunition"),
}


class ActionError(ValueError):
    """An action is not in its space; the message says what is wrong and what is allowed."""


class ActionMode(ABC):
    """Base class of the conversions from actions of learners to rows of the engine."""

    def __init__(self, fields: Sequence[Field], frames_per_action: int) -> None:
        """Create the mode for the action set of a track and a number of frames per action."""
        self.fields = tuple(fields)
        self.flags = np.array([field for field in fields if field > Field.LOOK], np.int64)
        self.frames = frames_per_action

    @property
    @abstractmethod
    def space(self) -> Space[Any]:
        """A new instance of the action space of one learner."""

    @property
    @abstractmethod
    def columns(self) -> tuple[Column, ...]:
        """The meaning of each number of an action, in the order of the space."""

    @abstractmethod
    def describe(self) -> dict[str, Any]:
        """Return what decoding actions without the engine needs, ready for JSON; ``mode`` is the name."""

    @abstractmethod
    def decode(self, actions: Any, yaws: NDArray[np.float64], rows: Rows) -> None:
        """Write the rows of N learners' actions.

        Args:
            actions: The actions of N learners, as Gymnasium batches them.
            yaws: (N,) degrees, of the learners.
            rows: (N, FIELDS), written.

        Raises:
            ActionError: The actions are not in the action space.
        """

    def decode_one(self, action: Any, yaws: NDArray[np.float64], rows: Rows) -> None:
        """Write the row of one learner's action; see ``decode``."""
        self.decode(np.asarray(action)[np.newaxis], yaws, rows)

    def _flag_names(self) -> list[str]:
        return [field.name.lower() for field in self.fields if field > Field.LOOK]

    def _flag_columns(self, unit: str, low: float, what: str) -> tuple[Column, ...]:
        """Return the columns of the flags; ``what`` says which numbers set a flag."""
        flags = [field for field in self.fields if field > Field.LOOK]
        return tuple(
            Column(field.name.lower(), unit, low, 1.0, f"{what}: {MEANINGS[field][1]}") for field in flags
        )

    def mask(self, alive: bool) -> Any:  # noqa: ARG002
        """Return a mask for ``Space.sample``; None if the space has no masks.

        Dead agents may only choose the first action. They do nothing, whatever they choose.
        """
        return None


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
            field.name.lower(): _mask(_choices(field), alive) if _choices(field) else None
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
            if field == _DIRECTION:
                low, high = 0.0, 360.0
            elif field == _SPEED:
                low, high = 0.0, MAX_WALK_SPEED
            elif field == _TURN:
                low, high = -TURN_LIMIT, TURN_LIMIT
            elif field == _LOOK:
                low, high = -LOOK_LIMIT, LOOK_LIMIT
            if not low <= value <= high:
                return field
    return VALID


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

    def decode(self, actions: ArrayLike, yaws: NDArray[np.float64], rows: Rows) -> None:  # noqa: ARG002
        """Write (N, k) numbers."""
        values = _as_array(actions, (len(rows), len(self.fields)), "fiu", np.float64)
        if not _decode_box(values, self.flags, TURN_STEP / self.frames, LOOK_STEP / self.frames, rows):
            bad = values[~(np.abs(values) <= 1.0)][0]
            raise ActionError(f"action holds {bad}, must be in [-1, 1]")


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
        rows[row, _DIRECTION] = arctangent(east, north)
        rows[row, _SPEED] = MAX_WALK_SPEED * min(1.0, np.sqrt(east * east + north * north))
        rows[row, _TURN] = turn * values[row, 2]
        rows[row, _LOOK] = look * values[row, 3]
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

    def decode(self, actions: ArrayLike, yaws: NDArray[np.float64], rows: Rows) -> None:  # noqa: ARG002
        """Write the rows of (N,) choices."""
        choices = _as_array(actions, (len(rows),), "iu", np.int64)
        if not _look_up(choices, self.table, rows):
            wrong = choices[(choices < 0) | (choices >= len(self.table))][0]
            raise ActionError(f"action is {wrong}, must be from 0 to {len(self.table) - 1}")

    def mask(self, alive: bool) -> NDArray[np.int8]:
        """Return (choices,) 1 for choices that may be sampled."""
        return _mask(len(self.table), alive)


@kernel
def _look_up(choices: NDArray[np.int64], table: NDArray[np.float32], rows: Rows) -> bool:
    """Write the rows of (N,) choices; return False if there is no such choice."""
    for row in range(choices.shape[0]):
        if not 0 <= choices[row] < table.shape[0]:
            return False
        for field in range(table.shape[1]):
            rows[row, field] = table[choices[row], field]
    return True


def _listed(numbers: Sequence[float]) -> str:
    return ", ".join(f"{number:g}" for number in numbers[:-1]) + f" or {numbers[-1]:g}"


class MultiDiscreteMode(ActionMode):
    """The mode ``multidiscrete``: a few choices per field."""

    def __init__(self, fields: Sequence[Field], frames_per_action: int) -> None:
        super().__init__(fields, frames_per_action)
        self.sizes = np.array(
            [len(WALKS), len(WALK_SPEEDS), len(TURNS), len(LOOKS), *[2] * len(self.flags)], np.int64
        )
        self._speeds = np.array(WALK_SPEEDS)
        self._turns, self._looks = np.array(TURNS) / self.frames, np.array(LOOKS) / self.frames

    @property
    def space(self) -> MultiDiscrete:
        """Walk (stand, or 8 directions clockwise from the view), speed, turn, look, jump and other flags."""
        return MultiDiscrete(self.sizes)

    @property
    def columns(self) -> tuple[Column, ...]:
        """The choices, in order."""
        speeds, turns, looks = (_listed(numbers) for numbers in (WALK_SPEEDS, TURNS, LOOKS))
        walk = "0 stands still; 1 to 8 walk 0, 45, … 315° clockwise from the view"
        return (
            Column("walk", "", 0.0, len(WALKS) - 1.0, walk),
            Column("speed", "", 0.0, len(WALK_SPEEDS) - 1.0, f"walk at {speeds} m/s"),
            Column("turn", "", 0.0, len(TURNS) - 1.0, f"turn by {turns}° in the step; positive is right"),
            Column("look", "", 0.0, len(LOOKS) - 1.0, f"look by {looks}° in the step; positive is down"),
            *self._flag_columns("", 0.0, "1"),
        )

    def describe(self) -> dict[str, Any]:
        """Return the choices: degrees clockwise from the view (None: stand), m/s, and degrees per frame."""
        return {
            "mode": "multidiscrete",
            "directions": [None, *(45.0 * place for place in range(DIRECTIONS))],
            "speeds": self._speeds.tolist(),
            "turns": self._turns.tolist(),
            "looks": self._looks.tolist(),
            "flags": self._flag_names(),
        }

    def decode(self, actions: ArrayLike, yaws: NDArray[np.float64], rows: Rows) -> None:
        """Write the rows of (N, k) choices."""
        choices = _as_array(actions, (len(rows), len(self.sizes)), "iu", np.int64)
        if not _decode_choices(
            choices, self.sizes, self.flags, self._speeds, self._turns, self._looks, yaws, rows
        ):
            wrong = choices[((choices < 0) | (choices >= self.sizes)).any(axis=1)][0]
            raise ActionError(f"action is {wrong.tolist()}, must be below {self.sizes.tolist()}")

    def mask(self, alive: bool) -> tuple[NDArray[np.int8], ...]:
        """Return a mask for each field."""
        return tuple(_mask(int(size), alive) for size in self.sizes)


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
        rows[row, _DIRECTION] = yaws[row] + 45.0 * (choice[0] - 1) if walks else 0.0
        rows[row, _SPEED] = speeds[choice[1]] if walks else 0.0
        rows[row, _TURN], rows[row, _LOOK] = turns[choice[2]], looks[choice[3]]
        for place in range(flags.shape[0]):
            rows[row, flags[place]] = choice[4 + place]
    return True


def _mask(choices: int, alive: bool) -> NDArray[np.int8]:
    mask = np.ones(choices, np.int8)
    if not alive:
        mask[1:] = 0
    return mask


def _as_array(values: ArrayLike, shape: tuple[int, ...], kinds: str, dtype: type) -> NDArray[Any]:
    """Return actions as an array.

    Raises:
        ActionError: They have another shape, or are not numbers of the right kind.
    """
    array = np.asarray(values)
    if array.shape != shape or array.dtype.kind not in kinds:
        wanted = "numbers" if "f" in kinds else "whole numbers"
        raise ActionError(
            f"actions are {array.dtype} of shape {array.shape}, must be {wanted} of shape {shape}"
        )
    return array if array.dtype == dtype and array.flags.c_contiguous else np.ascontiguousarray(array, dtype)


MODES: dict[str, type[ActionMode]] = {
    "dict": DictMode,
    "box": BoxMode,
    "baseline": BaselineMode,
    "multidiscrete": MultiDiscreteMode,
}


def action_mode(config: EnvConfig) -> ActionMode:
    """Return the action mode of an environment."""
    return MODES[config.action_mode](config.fields, config.frames_per_action)
