"""The action modes of choices: ``baseline``, one number, and ``multidiscrete`` and ``fine``, a few."""

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from gymnasium.spaces import Discrete, MultiDiscrete
from numpy.typing import ArrayLike, NDArray

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
    choice_mask,
)
from wildscav_engine.sensors.base import Column
from wildscav_engine.specs.actions import FIELDS, Field

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
        choices = as_array(actions, axes, (), np.int64)
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
        choices = as_array(actions, axes, (len(self.sizes),), np.int64)
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
