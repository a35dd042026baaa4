"""What may fill a seat that no learner has: a robot, a policy, or an object that chooses among them.

An entry of ``teammates`` or ``opponents`` is one of these:

- the name of a robot, which plays inside the simulation;
- a policy: a function from the observations of many seats to their actions, or an object with the methods
  ``reset`` and ``act`` (``StatefulPolicy``). ``PolicyOpponent`` gives it a name or settings of its own;
- a ``SeatController``, which reads the state of the simulation instead of observations;
- a ``Sampler``, which chooses one of the above anew for each episode, such as ``League``.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.envs.settings.functions import takes
from wildscav_engine.extensions import Registry
from wildscav_engine.specs.match_spec import SUBMISSION
from wildscav_engine.specs.validation import did_you_mean

if TYPE_CHECKING:
    from wildscav_engine.simulation.batch import Batch

Policy: TypeAlias = Callable[[Any], Any]  # from the observations of N seats to their actions
Indices: TypeAlias = NDArray[np.int64]

LONGEST_NAME = 100  # characters
ActionMode = Literal["dict", "box", "baseline", "multidiscrete", "fine", "keys"]
_ROBOTS: Registry[Any] = Registry("wildscav.robots")  # levels of ``Robot``


class StatefulPolicy(Protocol):
    """A policy with a memory, such as a recurrent network.

    Every seat that it may fill in an environment has a number, from 0 to below the number of matches times
    the number of seats behind the learners'. A seat keeps its number, so an array with a row for each number
    can hold the memory.
    """

    def reset(self, rows: Indices, seeds: NDArray[np.uint64]) -> None:
        """Begin new episodes in some seats.

        Args:
            rows: (N,) the numbers of the seats.
            seeds: (N,) a random seed for each, the same whenever the same episode is played.
        """

    def act(self, observations: Any, rows: Indices) -> Any:
        """Return the actions of some seats.

        Args:
            observations: Those of N seats: arrays by name (N, …), or (N, n) if they are flat.
            rows: (N,) the numbers of the seats.
        """


@dataclass(frozen=True, eq=False)
class PolicyOpponent:
    """A policy with a name, and with observations and actions that may differ from the learner's."""

    policy: Policy | StatefulPolicy
    name: str = ""  # in errors and in the table of a league; "": the name of the function or class
    sensors: Mapping[str, Mapping[str, Any]] | None = None  # None: as the learner's
    flat: bool | None = None  # None: as the learner's
    action_mode: ActionMode | None = None  # None: as the learner's

    def __post_init__(self) -> None:
        """Check that the policy can be called, and give it a name.

        Raises:
            ValueError: It is a class, or cannot be called with observations.
        """
        policy: Any = self.policy
        if isinstance(policy, type):
            raise ValueError(f"{policy.__name__} is a class, must be an object of it or a function")
        for method, wanted in _calls_of(policy).items():
            _check_call(policy, method, wanted)
        if not self.name:
            name = getattr(policy, "name", None) or getattr(policy, "__name__", None)
            object.__setattr__(self, "name", str(name or type(policy).__name__)[:LONGEST_NAME])

    @property
    def is_stateful(self) -> bool:
        """Whether it has the methods of ``StatefulPolicy``."""
        return callable(getattr(self.policy, "act", None))

    @property
    def settings_key(self) -> str:
        """Text that is equal for policies with equal settings."""
        return repr((self.sensors, self.flat, self.action_mode))


def _calls_of(policy: Any) -> dict[str, tuple[str, ...]]:
    """Return the arguments of each method that a policy must have."""
    if callable(getattr(policy, "act", None)):
        return {"reset": ("rows", "seeds"), "act": ("observations", "rows")}
    return {"__call__": ("observations",)}


def _check_call(policy: Any, method: str, wanted: tuple[str, ...]) -> None:
    """Check that a method takes some positional arguments."""
    shown = f"{type(policy).__name__}.{method}" if method != "__call__" else f"the policy {policy!r}"
    call = policy if method == "__call__" else getattr(policy, method, None)
    if not callable(call):
        raise ValueError(f"{shown} is missing; a policy has act(observations, rows) and reset(rows, seeds)")
    if not takes(call, *wanted):
        raise ValueError(f"{shown} must take ({', '.join(wanted)})")


class SeatController(ABC):
    """Decides for some seats of many matches by the state of the simulation itself."""

    name: str  # in errors and in the table of a league

    def check(self, track: str) -> None:  # noqa: B027  # most play every track
        """Check that the controller plays a track.

        Raises:
            ValueError: It does not.
        """

    @abstractmethod
    def begin(self, batch: "Batch", matches: Indices, seats: Indices) -> None:
        """Begin new episodes.

        Args:
            batch: The matches.
            matches: (N,) the index of the match of each seat.
            seats: (N,) the number of each seat in its match.
        """

    @abstractmethod
    def act(self, batch: "Batch", matches: Indices, seats: Indices) -> NDArray[np.float32]:
        """Return (N, FIELDS) the rows of actions of some seats; see ``specs/actions.py``."""


Player: TypeAlias = str | PolicyOpponent | SeatController


class Sampler(ABC):
    """Chooses who plays, anew for each episode."""

    @abstractmethod
    def sample(self, seats: int, random: Random) -> Sequence[Player | Policy | StatefulPolicy]:
        """Return who fills some seats in the next episode of a match.

        Args:
            seats: Their number.
            random: A source of random numbers, which depends only on the seed of the match.
        """

    def member(self, name: str) -> Player:  # noqa: ARG002
        """Return a player by its name, to continue a match from a saved state.

        Raises:
            LookupError: There is none of this name.
        """
        raise LookupError(f"{type(self).__name__} does not keep players by name")

    def record(self, name: str, result: float) -> None:  # noqa: B027  # a sampler need not learn from results
        """Receive the result of an episode against one player.

        Args:
            name: The player's name.
            result: 1 if the learner won, 0.5 for a draw, 0 if it lost.
        """


def read_entry(entry: object) -> Player | Sampler:
    """Return a validated entry of ``teammates`` or ``opponents``."""
    if isinstance(entry, Sampler):
        return entry
    return read_player(entry)


def read_player(entry: object) -> Player:
    """Return a validated player."""
    if isinstance(entry, str):
        return _checked_robot(entry)
    if isinstance(entry, PolicyOpponent | SeatController):
        return entry
    if callable(entry) or callable(getattr(entry, "act", None)):
        return PolicyOpponent(entry)  # type: ignore[arg-type]
    raise ValueError(
        f"{entry!r} cannot play; allowed are the name of a robot, a policy (observations) -> actions, "
        "a PolicyOpponent, a SeatController and a Sampler such as a League"
    )


def _checked_robot(name: str) -> str:
    robots = [robot.name for levels in _ROBOTS.values() for robot in levels]
    if name in robots or name == SUBMISSION:
        return name
    if "/" in name or Path(name).is_dir():
        raise ValueError(
            f"there is no robot {name!r}; a submission is given as "
            f"wildscav_training.opponents.submission({name!r})"
        )
    raise ValueError(
        f"there is no robot {name!r}{did_you_mean(name, robots)}; the robots are {', '.join(robots)}"
    )


def seat_entry(player: object) -> str:
    """Return what a match's spec contains for the seat of a player."""
    return player if isinstance(player, str) else SUBMISSION


def name_of(player: Player) -> str:
    """Return the name of a player."""
    return player if isinstance(player, str) else player.name
