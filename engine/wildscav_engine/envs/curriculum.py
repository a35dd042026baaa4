"""Curricula: options of a vector environment that become harder as the learner succeeds, row by row."""

from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv, VectorWrapper
from numpy.typing import NDArray

from wildscav_engine.envs.settings.config import change_config
from wildscav_engine.envs.settings.episodes import Plan

NEEDED = 0.8  # mean result that opens the next stage
WINDOW = 128  # episodes that it is measured on
ROUND = 64  # episodes that it is measured on at least, where rows share a place


class Curriculum:
    """A place in a list of stages, from easy to hard, that follows the results of a learner.

    The mean is measured only when a whole window of episodes has ended in the stage. The episodes are those
    of one row, one after the other; ``SharedCurriculum`` is for the rows of an environment together.
    """

    def __init__(
        self, stages: int, window: int = WINDOW, up: float = NEEDED, down: float | None = None
    ) -> None:
        """Begin with the first stage.

        Args:
            stages: Their number.
            window: The number of episodes that the mean is measured on.
            up: The mean result from which on the next stage begins.
            down: The mean result up to which the stage before begins again; None: there is no way back.

        Raises:
            ValueError: There is no stage or no window, or ``down`` is not below ``up``.
        """
        if stages < 1 or window < 1:
            raise ValueError(f"there are {stages} stages and {window} episodes, must be at least 1")
        if down is not None and not down < up:
            raise ValueError(f"down is {down} and up is {up}, must be less")
        self.stage, self._last, self._up, self._down = 0, stages - 1, up, down
        self._results: deque[float] = deque(maxlen=window)

    def record(self, results: Sequence[float]) -> None:
        """Receive the results of episodes that have ended, such as successes, 1 or 0."""
        self._results.extend(results)

    def advance(self) -> bool:
        """Go on to the next stage, or back, if that is due; return whether it is."""
        if len(self._results) < (self._results.maxlen or 0):
            return False
        mean, before = sum(self._results) / len(self._results), self.stage
        if mean >= self._up:
            self.stage = min(self.stage + 1, self._last)
        elif self._down is not None and mean <= self._down:
            self.stage = max(self.stage - 1, 0)
        if self.stage != before:
            self._results.clear()
        return self.stage != before

    def state(self) -> dict[str, Any]:
        """Return the state for a checkpoint."""
        return {"stage": self.stage, "results": list(self._results)}

    def restore(self, state: dict[str, Any]) -> None:
        """Continue from what ``state`` returned."""
        self.stage = int(state["stage"])
        self._results = deque(state["results"], maxlen=self._results.maxlen)


class SharedCurriculum(Curriculum):
    """A place that all rows of an environment share.

    Successes end sooner than failures do, so the first episodes that end in a stage are the lucky ones. What
    counts is therefore a round: equally many episodes of every row, all of which begin in the round.
    """

    def __init__(self, stages: int, rows: int, episodes: int = ROUND) -> None:
        """Begin with the first stage, in which the episodes of all rows begin.

        Args:
            stages: As for ``Curriculum``.
            rows: The number of rows.
            episodes: How many a round has at least.
        """
        self._each = -(-episodes // rows)  # episodes of a row in a round
        super().__init__(stages, window=self._each * rows)
        self._begin_round([self._each] * rows)

    def _begin_round(self, due: list[int]) -> None:
        self._due = due  # by row, until its last episode in the round ends; the running one may count, too
        self._round: list[float] = []

    def record_rows(self, rows: Sequence[int], results: Sequence[float]) -> None:
        """Receive the results, 0 to 1, of the episodes that have ended in some rows; others begin there.

        A round is over when all of its episodes have ended, or when those that have already suffice.
        """
        for row, result in zip(rows, results, strict=True):
            if 0 < self._due[row] <= self._each:
                self._round.append(result)
            self._due[row] = max(self._due[row] - 1, 0)
        size = self._each * len(self._due)
        if len(self._round) == size or sum(self._round) >= self._up * size:
            self.record(self._round + [0.0] * (size - len(self._round)))
            # An episode that already runs would be a long one more often than not, so it does not count.
            self._begin_round([self._each + (row not in rows) for row in range(len(self._due))])

    def advance(self) -> bool:
        """Go on to the next stage if that is due; then all rows must begin new episodes."""
        is_next = super().advance()
        if is_next:
            self._begin_round([self._each] * len(self._due))
        return is_next

    def state(self) -> dict[str, Any]:
        """Return the state for a checkpoint."""
        return {**super().state(), "round": list(self._round), "due": list(self._due)}

    def restore(self, state: dict[str, Any]) -> None:
        """Continue from what ``state`` returned."""
        super().restore(state)
        # Checkpoints of 0.2.0 have no round.
        self._round, self._due = list(state.get("round", [])), list(state.get("due", self._due))


class AdaptiveOptions(VectorWrapper):
    """A vector environment whose rows move up and down a list of option sets, each by its own results.

    A change holds from the next episode of the row on; in the mode ``SameStep`` that is the one after the
    episode that has just begun, whose result does not count. Infos have ``stage``, (N,).

    Attributes:
        curricula: The place of each row.
    """

    def __init__(
        self,
        env: VectorEnv[Any, Any, Any],
        stages: Sequence[Mapping[str, Any]],
        *,
        metric: str = "success",
        window: int = 20,
        up: float = NEEDED,
        down: float | None = 0.2,
    ) -> None:
        """Begin with the first stage in all rows.

        Args:
            env: A ``VectorArena``, wrapped or not.
            stages: Options of ``set_options``, from easy to hard. What one of them does not name is as the
                environment was made.
            metric: The metric of the track that is an episode's result.
            window: As for ``Curriculum``, with the next two.
            up: From which mean on a row goes up.
            down: To which mean a row goes down; None: never.

        Raises:
            ValueError: The environment is no ``VectorArena``, the track has no such metric, or an option
                cannot change or is invalid.
        """
        super().__init__(env)
        unwrapped: Any = env.unwrapped
        if not hasattr(unwrapped, "arena"):
            raise ValueError(
                f"env is of type {type(unwrapped).__name__}, must be a VectorArena, wrapped or not"
            )
        self._arena_env = unwrapped
        config, metrics = unwrapped.config, unwrapped.arena.metrics
        if metric not in metrics:
            raise ValueError(f"metric is {metric!r}; the metrics are {', '.join(metrics)}")
        self._metric, self._column = metric, metrics.index(metric)
        first = {name: getattr(config, name, None) for stage in stages for name in stage}
        self._stages = [{**first, **stage} for stage in stages]
        self.curricula = [Curriculum(len(stages), window, up, down) for _ in range(self.num_envs)]
        self._is_same_step = unwrapped.autoreset_mode == AutoresetMode.SAME_STEP
        self._outdated = np.zeros(self.num_envs, np.bool_)  # episodes that began before the row changed
        for stage in self._stages:  # before anything changes
            Plan(change_config(config, stage))
        self._arena_env.set_options(**self._stages[0])

    def reset(self, *, seed: Any = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Start new episodes, which count in the stages of their rows; see ``VectorArena.reset``."""
        seen, infos = super().reset(seed=seed, options=options)
        self._outdated[(options or {}).get("reset_mask", ...)] = False  # of all rows without a mask
        return seen, infos | {"stage": self._stage_of_rows()}

    def step(self, actions: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        """Play a step; the rows that are due change their options."""
        seen, rewards, terminated, truncated, infos = super().step(actions)
        ended = terminated | truncated
        if ended.any():
            results = self._results(infos)
            for row in np.flatnonzero(ended & ~self._outdated).tolist():
                self.curricula[row].record([float(results[row])])
            self._outdated[ended] = False
            for row in np.flatnonzero(ended).tolist():
                self._move(row)
        return seen, rewards, terminated, truncated, infos | {"stage": self._stage_of_rows()}

    def _stage_of_rows(self) -> NDArray[Any]:
        return np.array([curriculum.stage for curriculum in self.curricula])

    def _move(self, row: int) -> None:
        """Change the options of a row if that is due."""
        if self.curricula[row].advance():
            self._arena_env.set_options(rows=[row], **self._stages[self.curricula[row].stage])
            self._outdated[row] = self._is_same_step

    def _results(self, infos: Mapping[str, Any]) -> NDArray[Any]:
        """Return (N,) the metric of the episodes that have ended."""
        metrics = (infos["final_info"] if self._is_same_step else infos)["metrics"]
        values: NDArray[Any] = (
            metrics[self._metric] if isinstance(metrics, dict) else metrics[:, self._column]
        )
        return values
