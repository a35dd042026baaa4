"""Calls reward functions and observers, which are a user's own, for some seats of all matches of a batch."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.settings.functions import Learners, read_only
from wildscav_engine.envs.spaces.columns import OUTCOME, Part
from wildscav_engine.envs.spaces.observation import Layout, Readings, readings_space
from wildscav_engine.simulation.state import State

if TYPE_CHECKING:
    from wildscav_engine.simulation.batch import Batch


class FunctionReader:
    """Calls the functions of an environment for S seats in each of B matches.

    Only those of matches that were played or begun since the last call are asked: of the others, observations
    stay as they are, and the reward is 0.
    """

    def __init__(self, config: EnvConfig, seats: Sequence[int], matches: int, layout: Layout) -> None:
        """Prepare the calls for the seats with these numbers; ``layout`` is that of the rows."""
        spaces = readings_space(config)
        self._rewards = config.reward_functions
        self._observers: dict[str, tuple[Any, Any]] = {
            name: (call, spaces[name]) for name, call in config.observers.items()
        }
        self._seats = np.array(seats, np.int64)
        self._reward = layout.first(Part.OUTCOME) + OUTCOME.index("reward")
        self._first_term = layout.first(Part.TERMS) + len(config.reward_weights)
        self._is_new = np.ones(matches, np.bool_)
        self._frames = np.full(matches, -1, np.int64)  # at the last call
        self._last: Readings = {}
        self._states: tuple[State, State] | None = None  # of the batch, and its views for functions

    def __getstate__(self) -> dict[str, Any]:
        """Copy and pickle everything but the views: those of a copy would be of other arrays."""
        return {**vars(self), "_states": None}

    def begin(self, rows: Sequence[int]) -> None:
        """Note that some rows of the batch contain new matches."""
        self._is_new[list(rows)] = True

    def read(
        self,
        batch: "Batch",
        done: NDArray[np.bool_],
        rows: NDArray[np.float32],
        rewards: NDArray[np.float64],
        found: Readings,
    ) -> None:
        """Call all functions: write the terms and the reward into (B, S, width) rows, and (B, S) rewards.

        Nothing is paid to a seat whose episode had ended before, ``done`` (B, S). Observations (B, S, …) are
        added to ``found`` by their names.
        """
        frames = batch.state.matches.frame
        fresh = np.flatnonzero((frames != self._frames) | self._is_new)
        now = self._learners(batch, fresh)
        shape = len(fresh), len(self._seats)
        for name, (observer, space) in self._observers.items():
            seen = _observed(name, observer, now, space).reshape(*shape, *space.shape)
            if len(fresh) < len(frames):
                known = self._last[name].copy()
                known[fresh] = seen
                seen = known
            self._last[name] = seen
            found[name] = seen.copy()  # others may write into it
        unpaid = done[fresh] | self._is_new[fresh, np.newaxis]
        for column, (name, function) in enumerate(self._rewards.items(), self._first_term):
            who = f"the reward function {name!r}"
            paid = _numbers(who, function, now, (), np.float32).reshape(shape)
            rows[..., column] = 0.0
            rows[fresh, :, column] = np.where(unpaid, np.float32(0.0), paid)
            rows[..., self._reward] += rows[..., column]
        rewards[...] = rows[..., self._reward]
        self._frames[:] = frames
        self._is_new[:] = False

    def _learners(self, batch: "Batch", fresh: NDArray[np.int64]) -> Learners:
        """Return the seats in some matches."""
        if self._states is None or self._states[0] is not batch.state:
            agents, supplies, matches = batch.state
            views = State(read_only(agents), read_only(supplies), read_only(matches))
            self._states = batch.state, views
        of_matches, seats = np.repeat(fresh, len(self._seats)), np.tile(self._seats, len(fresh))
        is_new, actions = self._is_new[of_matches], batch.played[of_matches, seats]
        actions[is_new] = 0.0
        return Learners(of_matches, seats, is_new, actions, self._states[1], batch)


def _numbers(who: str, function: Any, now: Learners, shape: tuple[int, ...], dtype: Any) -> NDArray[Any]:
    """Return (N, *shape) finite numbers that a function returns; its dtype may lose only precision."""
    wanted = (len(now.matches), *shape)
    if not wanted[0]:
        return np.empty(wanted, dtype)
    returned = function(now)
    try:
        given = np.asarray(returned)
    except ValueError:  # rows of different lengths
        given = np.empty(0, object)
    casting: Any = "same_kind" if np.dtype(dtype).kind == "f" else "safe"
    if given.shape != wanted or not np.can_cast(given.dtype, dtype, casting):
        needed = f"must be {np.dtype(dtype)} of shape {wanted}"
        raise ValueError(f"{who} returned {given.dtype} of shape {given.shape}, {needed}")
    with np.errstate(over="ignore"):
        values: NDArray[Any] = given.astype(dtype) + np.zeros((), dtype)  # never minus zero
    if not np.isfinite(values).all():
        raise ValueError(f"{who} returned a number that is not finite")
    return values


def _observed(name: str, observer: Any, now: Learners, space: Any) -> NDArray[Any]:
    """Return what an observer returns for N learners, (N, …) in its space; errors as ``_numbers``."""
    who = f"the observer {name!r}"
    values = _numbers(who, observer, now, space.shape, space.dtype)
    if ((values < space.low) | (values > space.high)).any():
        raise ValueError(f"{who} returned a number outside its space, {space}")
    return values
