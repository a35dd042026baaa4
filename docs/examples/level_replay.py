"""Prioritized level replay: train on the maps from which there is most to learn, with Stable-Baselines3.

A level is a map. Its score is the mean magnitude of the advantages (GAE) when it was played last. Each
episode is on a new level, or again on one that was played: the likelier, the higher its score ranks and the
longer ago it was played. Run it with ``python docs/examples/level_replay.py``.

Method: Jiang, Grefenstette and Rocktäschel, "Prioritized Level Replay", ICML 2021.
"""

import argparse
from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecMonitor

from wildscav_engine.envs import StableVector
from wildscav_engine.maps.pools import random_maps
from wildscav_engine.specs.map_spec import MapSpec

TEMPERATURE = 0.1  # 0: only the level with the highest score
STALENESS = 0.1  # how much the time since a level was played counts, from 0 to 1


class Levels:
    """The scores of levels, and the choice of the next one."""

    def __init__(self, count: int, seed: int = 0) -> None:
        """Begin with levels that nobody has played."""
        self.scores = np.full(count, np.nan)  # (L,), nan until a level is played
        self._last = np.zeros(count)  # (L,) in which rollout it was played last
        self._random, self._rollout = np.random.default_rng(seed), 0

    def draw(self) -> int:
        """Return the next level: the more were played, the likelier one of these."""
        played = np.isfinite(self.scores)
        if self._random.random() < played.mean():
            return int(self._random.choice(np.flatnonzero(played), p=self.chances()))
        return int(self._random.choice(np.flatnonzero(~played)))

    def chances(self) -> NDArray[np.float64]:
        """Return the probability of each level that was played."""
        played = np.isfinite(self.scores)
        ranks = 1 + np.argsort(np.argsort(-self.scores[played]))
        by_score = (1.0 / ranks) ** (1.0 / TEMPERATURE)
        ages = self._rollout - self._last[played] + 1e-9
        return (1.0 - STALENESS) * by_score / by_score.sum() + STALENESS * ages / ages.sum()

    def update(self, played: NDArray[np.int64], advantages: NDArray[np.float32]) -> None:
        """Receive the level and the advantage of each step of a rollout, (T, N) each."""
        self._rollout += 1
        for level in np.unique(played):
            self.scores[level] = np.abs(advantages[played == level]).mean()
            self._last[level] = self._rollout


class Replay(BaseCallback):
    """Chooses the level of each episode."""

    def __init__(self, env: StableVector, levels: Levels, maps: Sequence[MapSpec]) -> None:
        """Take the map of each level."""
        super().__init__()
        self._arena, self._levels, self._maps = env.vector, levels, maps
        self._number = {one.seed: level for level, one in enumerate(maps)}
        self._played: list[list[int]] = []

    def _now(self) -> list[int]:
        batch = self._arena.arena.batch
        return [] if batch is None else [self._number[spec.map.seed] for spec in batch.specs]

    def _on_rollout_start(self) -> None:
        self._played = [self._now()]

    def _on_step(self) -> bool:
        self._played.append(self._now())
        for row in np.flatnonzero(self.locals["dones"]).tolist():
            self._arena.set_options(rows=[row], map=self._maps[self._levels.draw()])
        return True

    def _on_rollout_end(self) -> None:
        self._levels.update(np.array(self._played[:-1]), self.model.rollout_buffer.advantages)  # type: ignore[attr-defined]


def main() -> None:
    """Train, and print the levels from which there was most to learn."""
    parser = argparse.ArgumentParser(description="Train with prioritized level replay.")
    parser.add_argument("--steps", type=int, default=100_000)
    parser.add_argument("--levels", type=int, default=200)
    given = parser.parse_args()

    torch.set_num_threads(1)
    pool = random_maps("easy", size=given.levels)
    maps, levels = [pool[number].spec for number in range(given.levels)], Levels(given.levels)
    options: dict[str, Any] = {"flat": True, "action_mode": "multidiscrete", "time_limit": 30.0}
    rewards = {"target_reached": 1.0, "approach": 0.01}
    env = StableVector("navigation", 16, map=maps[0], rewards=rewards, **options)
    env.set_options([{"map": maps[levels.draw()]} for _ in range(env.num_envs)])
    monitor = VecMonitor(env, info_keywords=("metrics",))
    model = PPO("MlpPolicy", monitor, n_steps=256, batch_size=512, device="cpu", seed=0)
    model.learn(given.steps, Replay(env, levels, maps))
    successes = [episode["metrics"]["success"] for episode in model.ep_info_buffer or ()]
    count = int(np.isfinite(levels.scores).sum())
    print(f"{count} levels played; {np.mean(successes):.0%} of the last episodes succeeded")
    for level in np.argsort(-np.nan_to_num(levels.scores))[:3].tolist():
        print(f"level {level}: score {levels.scores[level]:.3f}")


if __name__ == "__main__":
    main()
