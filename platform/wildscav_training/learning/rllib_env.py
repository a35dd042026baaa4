"""The learners of all matches as a vector environment of Gymnasium, which RLlib makes in its processes."""

from dataclasses import replace
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from wildscav_training.learning.learner_rows import LearnerRows
from wildscav_training.learning.settings import TrainingSettings

NAME = "wildscav/learners-v0"
ENTRY = f"{__name__}:{NAME}"  # for a process that has not imported this module yet


class LearnersVectorEnv(VectorEnv[Any, Any, Any]):
    """One environment for each learner of each match. A step after an episode's end starts the next one.

    Attributes:
        ended: The return and the metrics of each episode that has ended since ``take_ended``.
    """

    metadata = {"autoreset_mode": AutoresetMode.NEXT_STEP}  # noqa: RUF012 - Gymnasium's own attribute

    def __init__(self, settings: TrainingSettings, num_envs: int) -> None:
        """Make the environment, which ``begin`` can make anew for another stage of the curriculum.

        Args:
            settings: The run.
            num_envs: Learners in all matches that this environment plays.
        """
        self.num_envs = num_envs
        self._settings = settings
        self.begin(settings.curriculum[0] if settings.curriculum else None, 0, 0)
        self.single_observation_space = self._rows.env.single_observation_space
        self.single_action_space = self._rows.env.single_action_space
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

    def begin(self, start_range: float | None, stage: int, part: int) -> None:
        """Make the matches of a stage of the curriculum; ``reset`` starts them.

        Args:
            start_range: Of the stage, m.
            stage: Its number.
            part: Of the seeds, for the process that plays.
        """
        self._stage, self._part = stage, part
        self.ended: list[dict[str, float]] = []
        self._rows = LearnerRows(self._settings, start_range, autoreset_mode="NextStep")

    def take_ended(self) -> list[dict[str, float]]:
        """Return the return and the metrics of each episode that has ended since the last call."""
        ended, self.ended = self.ended, []
        return ended

    def reset(self, *, seed: Any = None, options: Any = None) -> tuple[Any, dict[str, Any]]:  # noqa: ARG002
        """Start new episodes; the seed of the run decides about them."""
        return self._rows.reset(self._stage, self._part), {}

    def step(self, actions: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        """Play one step."""
        outcome = self._rows.step(np.asarray(actions))
        self.ended += outcome.ended
        return outcome.seen, outcome.rewards, outcome.terminated, outcome.truncated, {}


def share_of(settings: TrainingSettings, processes: int) -> TrainingSettings:
    """Return the settings of one of several processes that share the matches of a run; 0 counts as one."""
    given = settings.hyperparameters
    matches = max(1, given.matches // max(1, processes))
    return replace(settings, hyperparameters=replace(given, matches=matches))


gym.register(NAME, vector_entry_point=f"{__name__}:LearnersVectorEnv")
