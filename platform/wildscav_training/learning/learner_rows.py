"""The learners of many matches as rows of arrays, as the trainers of other libraries want environments."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav.errors import UserError
from wildscav_engine.tracks import TRACKS
from wildscav_training.learning.environment import APART, ROOM, make_env
from wildscav_training.learning.settings import TrainingSettings


class RowsOutcome(NamedTuple):
    """The outcome of a step for the N learners of all matches, match by match."""

    seen: NDArray[np.float32]  # (N, n) after the reset of the matches that ended
    rewards: NDArray[np.float32]  # (N,)
    terminated: NDArray[np.bool_]  # (N,) only where the match has ended, too
    truncated: NDArray[np.bool_]  # (N,)
    last: NDArray[np.float32] | None  # (N, n) before that reset; None if no match ended
    ended: list[dict[str, float]]  # the return and the metrics of each learner whose match ended


class LearnerRows:
    """B matches with L learners each, as N = B × L rows that share one policy."""

    def __init__(
        self, settings: TrainingSettings, start_range: float | None, autoreset_mode: str = "SameStep"
    ) -> None:
        """Make the environment.

        Args:
            settings: The run.
            start_range: The farthest start from the target, m; None: any.
            autoreset_mode: Gymnasium's: when a match that has ended is reset.

        Raises:
            UserError: An option is invalid, or learners would leave a match before the others.
        """
        self.settings = settings
        self.env = make_env(
            settings, settings.hyperparameters.matches, start_range, autoreset_mode=autoreset_mode
        )
        self.count = self.env.num_matches * self.env.num_agents
        if self.env.num_agents > 1 and TRACKS[settings.track].has_zone:
            raise UserError(
                f"the algorithm {settings.algorithm} learns {settings.track} with one learner, since several "
                "would leave one by one: give --option agents=1, or take --algorithm ppo",
                exit_code=2,
            )
        self.returns = np.zeros(self.count)  # of the episodes that are being played

    def reset(self, stage: int = 0, part: int = 0) -> NDArray[np.float32]:
        """Start the episodes of a stage of the curriculum, and return (N, n) observations.

        Args:
            stage: The number of the stage.
            part: Of the seeds, for processes that play at the same time.
        """
        first = self.settings.seed * APART + stage * ROOM + part * self.env.num_matches
        self.returns[:] = 0.0
        return self._rows(self.env.reset(seed=first))

    def step(self, actions: NDArray[np.integer[Any]]) -> RowsOutcome:
        """Play a step with actions (N, …)."""
        env = self.env
        shape = (env.num_matches, env.num_agents, *(env.single_action_space.shape or ()))
        outcome = env.step(actions.reshape(shape))
        self.returns += outcome.rewards.reshape(-1)
        over = np.zeros((env.num_matches, 1), np.bool_)
        over[list(outcome.ended)] = True
        terminated, truncated = (flags & over for flags in (outcome.terminated, outcome.truncated))
        last = None if outcome.final is None else self._rows(outcome.final.observation)
        return RowsOutcome(
            seen=self._rows(outcome.observation),
            rewards=outcome.rewards.reshape(-1).astype(np.float32),
            terminated=(terminated | (over & ~truncated)).reshape(-1),
            truncated=truncated.reshape(-1),
            last=last,
            ended=self._ended(outcome.ended, outcome.metrics),
        )

    def _ended(self, matches: Sequence[int], metrics: NDArray[np.float64]) -> list[dict[str, float]]:
        if not matches:
            return []
        by_match = self.returns.reshape(self.env.num_matches, -1)
        totals = by_match[list(matches)].reshape(-1).tolist()
        by_match[list(matches)] = 0.0
        names = self.env.arena.metrics
        rows = metrics.reshape(len(totals), len(names)).tolist()
        return [
            {"return": total, **dict(zip(names, row, strict=True))}
            for total, row in zip(totals, rows, strict=True)
        ]

    @staticmethod
    def _rows(observation: Any) -> NDArray[np.float32]:
        return np.array(observation.reshape(-1, observation.shape[-1]), np.float32)

    def state(self) -> list[bytes]:
        """Return every match as bytes."""
        return [self.env.get_state(row) for row in range(self.env.num_matches)]

    def restore(self, matches: Sequence[bytes], returns: NDArray[np.float64]) -> None:
        """Continue from what ``state`` and ``returns`` were."""
        for row, match in enumerate(matches):
            self.env.set_state(row, match)
        self.returns = returns.copy()


def successes(ended: Sequence[Mapping[str, float]]) -> list[float]:
    """Return the successes among episodes, where the track has any, for a curriculum."""
    return [episode["success"] for episode in ended if "success" in episode]
