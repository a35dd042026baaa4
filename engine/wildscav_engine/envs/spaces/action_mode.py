"""What all action modes share: their base class, and checks of what learners chose."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Space
from numpy.typing import ArrayLike, NDArray

from wildscav_engine.sensors.base import Column
from wildscav_engine.specs.actions import Field

Rows = NDArray[np.float32]  # (N, FIELDS), written

# The columns of rows, as kernels take them.
DIRECTION, SPEED = int(Field.WALK_DIRECTION), int(Field.WALK_SPEED)
TURN, LOOK = int(Field.TURN), int(Field.LOOK)

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


def choice_mask(choices: int, alive: bool) -> NDArray[np.int8]:
    """Return (choices,) 1 for choices that may be sampled: all, or only the first for a dead agent."""
    mask = np.ones(choices, np.int8)
    if not alive:
        mask[1:] = 0
    return mask


def as_array(values: ArrayLike, shape: tuple[int, ...], kinds: str, dtype: type) -> NDArray[Any]:
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
