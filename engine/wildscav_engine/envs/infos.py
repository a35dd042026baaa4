"""The infos of environments. Their structure is the same in every step."""

from collections.abc import Iterable
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


def info_of(arena: Arena, row: NDArray[np.float32], measured: Iterable[float] = ()) -> Info:
    """Return the infos of one learner.

    Args:
        arena: The arena.
        row: (width,) the learner's row of the output.
        measured: Its metrics, if its episode ended with this step.
    """
    values = [*measured] or [0.0] * len(arena.metrics)
    if arena.config.flat:
        return {
            "events": arena.events(row).astype(np.int64),
            "reward_terms": arena.reward_terms(row),
            "metrics": np.array(values),
        }
    return {
        "events": dict(zip(EVENTS, map(int, arena.events(row).tolist()), strict=True)),
        "reward_terms": dict(zip(arena.terms, arena.reward_terms(row).tolist(), strict=True)),
        "metrics": dict(zip(arena.metrics, values, strict=True)),
    }
