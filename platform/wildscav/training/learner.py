"""What all algorithms of ``wildscav train`` have in common, and how a run gets its own."""

import time
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from typing import Any, Protocol

from wildscav.training.algorithms import ALGORITHMS, RLLIB, STABLE
from wildscav.training.settings import TrainingSettings


class Learner(Protocol):
    """A policy in training."""

    steps: int  # of all learners so far
    total: int  # rollouts of the run

    @property
    def rollouts(self) -> int:
        """Rollouts so far."""

    @property
    def policy(self) -> Any:
        """The layers one after the other, from rows (N, n) to scores (N, C)."""

    def iterate(self) -> dict[str, float]:
        """Play a rollout, learn from it, and return figures about both by name."""

    def state(self) -> dict[str, Any]:
        """Return everything that the next iteration depends on: tensors, numbers and lists of them."""

    def restore(self, state: Mapping[str, Any]) -> None:
        """Continue from what ``state`` returned."""


@contextmanager
def learning(settings: TrainingSettings) -> Iterator[Learner]:
    """Yield the learner of a run, which knows nothing yet.

    Raises:
        UserError: The environment cannot be made, or is not one that the algorithm learns.
    """
    library = ALGORITHMS[settings.algorithm].library
    if library == RLLIB:
        from wildscav.training.rllib_cluster import connected

        with connected(settings.address, settings.workers):
            from wildscav.training.rllib_learner import RllibLearner

            with closing(RllibLearner(settings)) as learner:
                yield learner
    elif library == STABLE:
        from wildscav.training.stable_learner import StableLearner

        yield StableLearner(settings)
    else:
        from wildscav.training.ppo import PPO

        yield PPO(settings)


def processor_seconds(learner: Learner) -> float:
    """Return the processor time of this process, and of those that play for the learner, s."""
    return time.process_time() + float(getattr(learner, "worker_seconds", 0.0))
