"""The action modes of the training environments: from a choice to an action of the SDK."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wildscav.agent import ACTION_FIELDS, Action
from wildscav.policy.elementary_functions import arctangent
from wildscav.policy.errors import PolicyError
from wildscav.policy.keys import MOST_COUNTS, MOUSE, WALKS, Keys


class ActionMode(ABC):
    """An action space: turns a choice of the network into an action."""

    sizes: tuple[int, ...] = ()  # the number of choices in each dimension; () for a continuous space
    numbers = 0  # how many numbers in [-1, 1] a choice has, for a continuous space

    @abstractmethod
    def action(self, choice: Any, yaw: float) -> Action:
        """Return the action that a choice stands for; the agent's yaw is in degrees.

        Raises:
            PolicyError: The choice is not in that space.
        """


class DictMode(ActionMode):
    """The fields of an action by name."""

    def __init__(self, description: Mapping[str, Any]) -> None:
        self._fields = tuple(description["fields"])

    def action(self, choice: Any, yaw: float) -> Action:  # noqa: ARG002
        """Return the action with these fields. See ``ActionMode.action``."""
        if not isinstance(choice, Mapping) or set(choice) != set(self._fields):
            raise PolicyError(f"the choice is {choice!r}, must be a mapping of {', '.join(self._fields)}")
        return Action(**{name: np.asarray(value).item() for name, value in choice.items()})


class KeysMode(ActionMode):
    """Keys and a mouse, by name."""

    def __init__(self, description: Mapping[str, Any]) -> None:
        self._names = (*WALKS, *MOUSE, *description["flags"])
        self._most, self._frames = int(description["most"]), int(description["frames"])

    def action(self, choice: Any, yaw: float) -> Action:
        """Return the action of these keys. See ``ActionMode.action``."""
        if not isinstance(choice, Mapping) or set(choice) != set(self._names):
            raise PolicyError(f"the choice is {choice!r}, must be a mapping of {', '.join(self._names)}")
        values = {name: np.asarray(value).item() for name, value in choice.items()}
        for name, value in values.items():
            if not (abs(value) <= MOST_COUNTS if name in MOUSE else value in (0, 1)):
                allowed = f"from {-MOST_COUNTS} to {MOST_COUNTS}" if name in MOUSE else "0 or 1"
                raise PolicyError(f"{name} is {value!r}, must be {allowed}")
        return Keys(**values).action_with(yaw, self._most, self._frames)


class BoxMode(ActionMode):
    """Numbers in [-1, 1]: walk east, walk north, turn, look, and flags, which are set above 0."""

    def __init__(self, description: Mapping[str, Any]) -> None:
        self._flags = tuple(description["flags"])
        self._speed, self._turn = float(description["walk_speed"]), float(description["turn"])
        self._look = float(description["look"])
        self.numbers = 4 + len(self._flags)

    def action(self, choice: Any, yaw: float) -> Action:  # noqa: ARG002
        """Return the action of (k,) numbers. See ``ActionMode.action``."""
        values = np.asarray(choice, np.float64)
        if values.shape != (self.numbers,) or not (np.abs(values) <= 1.0).all():
            raise PolicyError(f"the choice is {choice!r}, must be {self.numbers} numbers in [-1, 1]")
        east, north, turn, look, *flags = values.tolist()
        return Action(
            walk_direction=arctangent(east, north),
            walk_speed=self._speed * min(1.0, float(np.sqrt(east * east + north * north))),
            turn=self._turn * turn,
            look=self._look * look,
            **{name: flag > 0.0 for name, flag in zip(self._flags, flags, strict=True)},
        )


class TableMode(ActionMode):
    """An index into a table of actions."""

    def __init__(self, description: Mapping[str, Any]) -> None:
        self._table = [tuple(row) for row in description["table"]]
        self.sizes = (len(self._table),)

    def action(self, choice: Any, yaw: float) -> Action:  # noqa: ARG002
        """Return the action in a row of the table. See ``ActionMode.action``."""
        (row,) = _whole_numbers(choice, self.sizes)
        values = self._table[row]
        known = [*ACTION_FIELDS][: len(values)]  # a table from before there were further fields has fewer
        return Action(**dict(zip(known, values, strict=True)))


class ChoicesMode(ActionMode):
    """A list of choices for each of direction, speed, turn and look, and flags."""

    def __init__(self, description: Mapping[str, Any]) -> None:
        self._directions: list[float | None] = list(description["directions"])  # None: stand
        self._speeds, self._turns = list(description["speeds"]), list(description["turns"])
        self._looks, self._flags = list(description["looks"]), tuple(description["flags"])
        lists: Sequence[Sequence[Any]] = (self._directions, self._speeds, self._turns, self._looks)
        self.sizes = (*(len(values) for values in lists), *[2] * len(self._flags))

    def action(self, choice: Any, yaw: float) -> Action:
        """Return the action of (k,) integers. See ``ActionMode.action``."""
        walk, speed, turn, look, *flags = _whole_numbers(choice, self.sizes)
        direction = self._directions[walk]
        return Action(
            walk_direction=0.0 if direction is None else yaw + direction,
            walk_speed=0.0 if direction is None else self._speeds[speed],
            turn=self._turns[turn],
            look=self._looks[look],
            **{name: flag == 1 for name, flag in zip(self._flags, flags, strict=True)},
        )


def _whole_numbers(choice: ArrayLike, sizes: Sequence[int]) -> list[int]:
    """Return a choice as integers, each from 0 and below its size."""
    values: NDArray[Any] = np.asarray(choice)
    if values.dtype.kind not in "iu" or values.size != len(sizes):
        raise PolicyError(f"the choice is {choice!r}, must be {len(sizes)} whole numbers")
    numbers: list[int] = values.reshape(-1).tolist()
    if any(not 0 <= number < size for number, size in zip(numbers, sizes, strict=True)):
        raise PolicyError(f"the choice is {numbers}, must be at least 0 and below {list(sizes)}")
    return numbers


MODES: dict[str, type[Any]] = {
    "dict": DictMode,
    "box": BoxMode,
    "baseline": TableMode,
    "multidiscrete": ChoicesMode,
    "fine": ChoicesMode,
    "keys": KeysMode,
}


def action_mode(description: Mapping[str, Any]) -> ActionMode:
    """Return the action mode of a description, or raise a PolicyError if it is not known here."""
    name = description.get("mode")
    if name not in MODES:
        raise PolicyError(
            f"policy.json has the action mode {name!r}; those known here are {', '.join(MODES)}"
        )
    mode: ActionMode = MODES[name](description)
    return mode
