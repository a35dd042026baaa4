"""What all algorithms of ``wildscav train`` have in common, and how a run gets its own."""

from collections.abc import Mapping
from typing import Any, Protocol

from wildscav.training.algorithms import ALGORITHMS, STABLE
from wildscav.training.settings import TrainingSettings


class Learner(Protocol):
    """A policy in training."""

    steps: int  # of all learners so far
    rollouts: int  # so far
    total: int  # rollouts of the run
    policy: Any  # layers one after the other, from rows (N, n) to scores (N, C)

    def iterate(self) -> dict[str, float]:
        """Play a rollout, learn from it, and return figures about both by name."""

    def state(self) -> dict[str, Any]:
        """Return everything that the next iteration depends on: tensors, numbers and lists of them."""

    def restore(self, state: Mapping[str, Any]) -> None:
        """Continue from what ``state`` returned."""


def make_learner(settings: TrainingSettings) -> Learner:
    """Return the learner of a run, which knows nothing yet.

    Raises:
        UserError: The environment cannot be made, or is not one that the algorithm learns.
    """
    if ALGORITHMS[settings.algorithm].library == STABLE:
        from wildscav.training.stable_learner import StableLearner

        return StableLearner(settings)
    from wildscav.training.ppo import PPO

    return PPO(settings)
