"""The infos of environments. Their structure is the same in every step."""

from collections.abc import Sequence
from typing import Any, NotRequired, TypedDict

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.envs.arena import Arena
from wildscav_engine.envs.spaces.columns import EVENTS


class Info(TypedDict):
    """The infos of one learner after a reset or a step; the values are arrays if the environment is flat."""

    events: dict[str, int] | NDArray[np.int64]  # by ``columns.EVENTS``: counts of the step
    reward_terms: dict[str, float] | NDArray[np.float32]  # the weighted terms
    # By the track's metrics, in the last step of the episode; 0 before.
    metrics: dict[str, float] | NDArray[np.float64]
    action_mask: NotRequired[Any]  # for several agents: the mask for ``Space.sample``


class Infos:
    """Makes the infos of an arena's learners."""

    def __init__(self, arena: Arena) -> None:
        """Prepare the infos of steps without events, rewards and metrics, which are most of them."""
        self._arena = arena
        self._events, self._terms = dict.fromkeys(EVENTS, 0), dict.fromkeys(arena.terms, 0.0)
        self._metrics = dict.fromkeys(arena.metrics, 0.0)
        self._nothing = [0.0] * len(EVENTS), [0.0] * len(arena.terms)  # counts and terms

    def of(self, counts: list[float], terms: list[float], measured: Sequence[float] = ()) -> Info:
        """Return the infos of one learner by its events, reward terms, and metrics if its episode ended."""
        no_counts, no_terms = self._nothing
        if self._arena.config.flat:
            return {
                "events": np.array(counts, np.int64),
                "reward_terms": np.array(terms, np.float32),
                "metrics": np.array(measured or [0.0] * len(self._metrics)),
            }
        events, rewards, metrics = self._events.copy(), self._terms.copy(), self._metrics.copy()
        if counts != no_counts:
            events.update(zip(EVENTS, map(int, counts), strict=True))
        if terms != no_terms:
            rewards.update(zip(rewards, terms, strict=True))
        if measured:
            metrics.update(zip(metrics, measured, strict=True))
        return {"events": events, "reward_terms": rewards, "metrics": metrics}
