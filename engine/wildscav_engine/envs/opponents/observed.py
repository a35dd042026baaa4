"""The observations of policies that fill seats: all seats of all matches at once, with their own settings."""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wildscav_engine.envs.settings.config import EnvConfig, with_changes
from wildscav_engine.envs.settings.players import Indices, PolicyOpponent
from wildscav_engine.envs.spaces.actions import ActionMode, action_mode
from wildscav_engine.envs.spaces.observation import Observation, part_of
from wildscav_engine.envs.spaces.seat_reader import SeatReader

if TYPE_CHECKING:
    from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
    from wildscav_engine.simulation.batch import Batch

View = Callable[[int], "MatchInBatch"]


class Settings(NamedTuple):
    """The observations and actions of a policy."""

    config: EnvConfig
    mode: ActionMode
    key: str  # equal for policies with equal observations


def settings_of(config: EnvConfig, opponent: PolicyOpponent) -> Settings:
    """Return the settings of a policy: its own where it has any, otherwise the learner's."""
    own: Mapping[str, Any] = {
        name: value
        for name in ("sensors", "flat", "action_mode")
        if (value := getattr(opponent, name)) is not None
    }
    # Its rewards are of no interest.
    try:
        changed = with_changes(config, {"rewards": {}, "reward_functions": {}, **own})
    except ValueError as error:
        raise ValueError(f"the opponent {opponent.name!r}: {error}") from None
    return Settings(changed, action_mode(changed), f"{changed.flat} {changed.read_sensors()}")


class Seated(NamedTuple):
    """The seats that one player fills, match by match."""

    matches: Indices  # (N,) the index of each seat's match
    seats: Indices  # (N,) its number in the match

    def in_some(self, chosen: Any) -> "Seated":
        """Return the seats that a mask (N,) or indices choose."""
        return Seated(self.matches[chosen], self.seats[chosen])


class ObservedSeats:
    """Reads the observations of some seats of all matches, at most once per step."""

    def __init__(self, config: EnvConfig, seats: Sequence[int], matches: int) -> None:
        """Create a reader for the seats with these numbers, in ascending order."""
        self.seats = tuple(seats)
        self._reader = SeatReader(config, seats, matches)
        self._numbers = np.array(seats, np.int64)
        self._size = matches * len(seats)
        self._observation: Observation | None = None

    def begin(self, batch: "Batch", rows: Sequence[int]) -> None:
        """Note that some rows of the batch contain new matches."""
        self._reader.begin(batch, rows)

    def forget(self) -> None:
        """Forget what was read, because the matches have changed."""
        self._observation = None

    def of(self, batch: "Batch", view: View, seated: Seated) -> Observation:
        """Return the present observations of some seats: arrays by name (N, …), or (N, n) if flat."""
        if self._observation is None:
            self._observation, _ = self._reader.read(batch, view)
        if len(seated.matches) == self._size:  # all of them, in order
            return _joined(self._observation)
        places = np.searchsorted(self._numbers, seated.seats)
        return part_of(self._observation, (seated.matches, places))


def _joined(observation: Observation) -> Observation:
    """Return the observations of all seats along one axis."""
    if isinstance(observation, dict):
        return {name: values.reshape(-1, *values.shape[2:]) for name, values in observation.items()}
    return observation.reshape(-1, *observation.shape[2:])
