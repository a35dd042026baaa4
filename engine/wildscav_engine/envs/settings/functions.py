"""Rewards and observations of a user's own: functions that are called once a step for all learners.

They are given ``Learners`` and may read the whole state of the matches, so they decide what learners know.
"""

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, TypeVar

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import ArrayLike, NDArray

from wildscav_engine.tracks.rewards import REWARD_TERMS

if TYPE_CHECKING:
    from wildscav_engine.maps.game_map import GameMap
    from wildscav_engine.simulation.batch import Batch
    from wildscav_engine.simulation.state import State
    from wildscav_engine.simulation.systems.visibility import Seen
    from wildscav_engine.specs.match_spec import MatchSpec

Arrays = TypeVar("Arrays", bound=tuple[Any, ...])


@dataclass(frozen=True, eq=False)
class Learners:
    """N learners whose matches were played or have begun, and the matches. Nothing in them can be written."""

    matches: NDArray[np.int64]  # (N,) the index of each learner's match
    seats: NDArray[np.int64]  # (N,) its seat
    is_new: NDArray[np.bool_]  # (N,) whether its episode begins or was restored
    actions: NDArray[np.float32]  # (N, FIELDS) what it did, see ``specs/actions.py``; 0 if it is new
    state: "State"  # of all B matches, see ``simulation/state.py``
    _batch: "Batch" = field(repr=False)

    def of(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return (N, …) the values of these learners among (B, A, …) those of all agents."""
        return values[self.matches, self.seats]

    @property
    def seen(self) -> "Seen":
        """What every agent sees, computed on demand; see ``simulation/systems/visibility.py``."""
        return read_only(self._batch.seen)

    @property
    def maps(self) -> "Sequence[GameMap]":
        """The map of each of the B matches."""
        return self._batch.maps

    @property
    def specs(self) -> "Sequence[MatchSpec]":
        """The spec of each of the B matches."""
        return self._batch.specs


# Returns (N,) the rewards of the step; what it returns for new learners does not count.
RewardFunction: TypeAlias = Callable[[Learners], ArrayLike]


class Observer(Protocol):
    """An observation of a user's own."""

    space: Box  # of one learner

    def __call__(self, now: Learners, /) -> ArrayLike:
        """Return (N, …) the observations of the learners, each in the space."""


def read_only(arrays: Arrays) -> Arrays:
    """Return a NamedTuple of arrays with views of them that cannot be written."""
    views = [array.view() for array in arrays]
    for view in views:
        view.flags.writeable = False
    return type(arrays)(*views)


def checked_rewards(functions: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return reward functions by name; ValueError if one cannot be called or is named as a reward term."""
    for name, function in functions.items():
        _check_call(name, function)
        if name in REWARD_TERMS:
            raise ValueError(f"{name!r} is the name of a reward term: choose another one")
    return functions


def checked_observers(observers: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return observers by name; ValueError if one cannot be called or its space is no Box of numbers."""
    for name, observer in observers.items():
        _check_call(name, observer)
        space = getattr(observer, "space", None)
        if not isinstance(space, Box) or space.dtype.kind not in "biuf":
            raise ValueError(f"the space of {name!r} is {space}, must be a Box of numbers")
    return observers


def _check_call(name: str, function: Any) -> None:
    if not callable(function) or isinstance(function, type):
        raise ValueError(f"{name!r} is {function!r}, must be a function or an object that can be called")
    if not takes(function, "learners"):
        raise ValueError(f"{name!r} must take one argument, the learners")


def takes(function: Callable[..., Any], *arguments: str) -> bool:
    """Return whether a function can be called with so many arguments."""
    try:
        inspect.signature(function).bind(*arguments)
    except TypeError:
        return False
    except ValueError:  # a function without a signature, which may take anything
        return True
    return True
