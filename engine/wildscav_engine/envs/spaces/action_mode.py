"""What all action modes share: their base class, and checks of what learners chose."""

from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping, Sequence
from reprlib import repr as shortened
from typing import Any

import numpy as np
from gymnasium.spaces import Space
from numpy.typing import ArrayLike, NDArray

from wildscav_engine.sensors.base import Column
from wildscav_engine.specs.actions import MEANINGS, Field

Rows = NDArray[np.float32]  # (N, FIELDS), written
Yaws = NDArray[np.float64]  # (N,) degrees
Axes = tuple[int, ...]  # such as (N,), or () for one action; of N elements together
NUMBERS = "biuf"  # the kinds of dtypes that are numbers
FLOATS = (np.dtype(np.float64), np.dtype(np.float32))
WHOLE = (np.dtype(np.int64),)

# The columns of rows, as kernels take them.
DIRECTION, SPEED = int(Field.WALK_DIRECTION), int(Field.WALK_SPEED)
TURN, LOOK = int(Field.TURN), int(Field.LOOK)
VALID = -1  # in place of the index of a number that is not allowed


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
    def decode(self, actions: Any, yaws: Yaws, rows: Rows, axes: Axes) -> None:
        """Write the rows of the actions of N learners, as Gymnasium batches them, with these leading axes.

        Raises:
            ActionError: The actions are not in the action space.
        """

    def _flag_names(self) -> list[str]:
        return [field.name.lower() for field in self.fields if field > Field.LOOK]

    def _flag_columns(self, unit: str, low: float, what: str) -> tuple[Column, ...]:
        """Return the columns of the flags; ``what`` says which numbers set a flag."""
        flags = [field for field in self.fields if field > Field.LOOK]
        return tuple(
            Column(field.name.lower(), unit, low, 1.0, f"{what}: {MEANINGS[field].meaning}")
            for field in flags
        )

    def mask(self, alive: bool) -> Any:  # noqa: ARG002
        """Return a mask for ``Space.sample``; None if the space has no masks.

        Dead agents may only choose the first action. They do nothing, whatever they choose.
        """
        return None


def choice_mask(choices: int, alive: bool) -> NDArray[np.int8]:
    """Return (choices,) 1 for choices that may be sampled: all, or only the first for a dead agent."""
    mask = np.ones(choices, np.int8)
    if not alive:
        mask[1:] = 0
    return mask


def as_array(
    values: ArrayLike, axes: Axes, own: Axes, kinds: tuple[np.dtype[Any], ...], name: str = "actions"
) -> NDArray[Any]:
    """Return (*axes, *own) actions of N learners as (N, *own) numbers.

    One number may also be an array of one element. Numbers of other dtypes than ``kinds`` become the first
    one. If that is of integers, they have to be whole.
    """
    shape, array = axes + own, values
    if type(array) is not np.ndarray or array.dtype not in kinds or array.shape != shape:
        array = _converted(values, shape, kinds[0], name)
    if not array.flags.c_contiguous:
        array = np.ascontiguousarray(array)
    if len(axes) == 1:
        return array
    return array.reshape(-1, *own) if axes else array[np.newaxis]


def _converted(values: ArrayLike, shape: Axes, kind: np.dtype[Any], name: str) -> NDArray[Any]:
    """Return numbers as an array of some dtype."""
    try:
        array = np.asarray(values)
    except ValueError:  # rows of different lengths
        array = np.asarray(repr(values))
    if array.dtype.kind not in NUMBERS or (array.shape != shape and (shape or array.size != 1)):
        given = f"{array.dtype} of shape {array.shape}" if array.ndim else shortened(array.item())
        raise ActionError(f"{name}: {given}, must be numbers of shape {shape}")
    if kind.kind == "i" and array.dtype.kind == "f" and not is_whole(array).all():
        raise ActionError(f"{name}: {array[~is_whole(array)].flat[0]:g}, must be whole numbers")
    return array.astype(kind).reshape(shape)


def check_names(actions: Any, names: Collection[str]) -> None:
    """Check that actions are a dictionary with exactly these names."""
    if not isinstance(actions, Mapping) or actions.keys() != set(names):
        given = f"a {type(actions).__name__}"
        if isinstance(actions, Mapping):
            given += f" of {', '.join(map(str, actions)) or 'nothing'}"
        raise ActionError(f"actions: {given}, must be a dictionary of {', '.join(names)}")


def named_values(actions: Any, names: Sequence[str], axes: Axes) -> NDArray[np.float64]:
    """Return the actions of N learners, (*axes,) numbers of each name, as (len(names), N) numbers."""
    check_names(actions, names)
    try:
        values = np.array([actions[name] for name in names])
    except ValueError:  # of different shapes
        values = np.empty(0)
    if values.shape != (len(names), *axes) or values.dtype.kind not in NUMBERS:
        values = np.array([as_array(actions[name], axes, (), FLOATS[:1], name) for name in names])
    return np.ascontiguousarray(values, np.float64).reshape(len(names), -1)


def is_whole(array: NDArray[Any]) -> NDArray[np.bool_]:
    """Return whether each number is whole, and small enough for an integer."""
    return np.asarray((array == np.floor(array)) & (np.abs(array) < 2.0**53))
