"""What environments tell besides observations and rewards. The structure is the same in every step."""

from typing import Any, NotRequired, TypedDict

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.envs.arena import Arena
from wildscav_engine.envs.spaces.columns import EVENTS


class Info(TypedDict):
    """What one learner is told besides, after a reset or a step; arrays in this order if it is flat."""

    events: dict[str, int] | NDArray[np.int64]  # by ``columns.EVENTS``: what happened to it in the step
    reward_terms: dict[str, float] | NDArray[np.float32]  # what each term paid
    metrics: (
        dict[str, float] | NDArray[np.float64]
    )  # by the track's metrics, in the last step of the episode; 0 before
    action_mask: NotRequired[Any]  # of several agents: what may be sampled, as ``Space.sample`` takes it


def info_of(arena: Arena, match: int, learner: int, row: NDArray[np.float32], *, ended: bool) -> Info:
    """Return what one learner is told.

    Args:
        arena: Where it plays.
        match: In which match.
        learner: Which of its learners it is.
        row: (width,) its row.
        ended: Whether its episode has ended with this step.
    """
    if arena.config.flat:
        measured = list(arena.measure(match, learner).values()) if ended else [0.0] * len(arena.metrics)
        return {
            "events": arena.events(row).astype(np.int64),
            "reward_terms": arena.paid(row),
            "metrics": np.array(measured),
        }
    return {
        "events": dict(zip(EVENTS, map(int, arena.events(row).tolist()), strict=True)),
        "reward_terms": dict(zip(arena.terms, arena.paid(row).tolist(), strict=True)),
        "metrics": dict(arena.measure(match, learner)) if ended else dict.fromkeys(arena.metrics, 0.0),
    }
