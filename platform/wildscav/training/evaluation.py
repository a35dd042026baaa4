"""How good a policy is: the mean metrics of episodes that it has not met in training."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import torch

from wildscav.training.ppo import Choices, in_space, make_env, rows_of, sizes_of
from wildscav.training.settings import TrainingSettings

FIRST = 2**63  # seeds of evaluations, above those of training


class Score(NamedTuple):
    """The mean metrics of one way to play on one split."""

    split: str  # "train": maps of training, other episodes; "test": other maps as well
    choose: str  # "sampled" or "deterministic"
    episodes: int
    metrics: Mapping[str, float]  # means by name


def evaluate(policy: Any, settings: TrainingSettings, episodes: int) -> list[Score]:
    """Play a policy on both splits, sampled and always the likeliest, without curriculum.

    Args:
        policy: From rows (N, n) to scores (N, C).
        settings: The run that it comes from.
        episodes: Matches for each score.
    """
    return [
        Score(split, choose, episodes, _play(policy, settings, episodes, split, choose == "deterministic"))
        for split in ("train", "test")
        for choose in ("sampled", "deterministic")
    ]


@torch.no_grad()  # type: ignore[untyped-decorator]
def _play(
    policy: Any, settings: TrainingSettings, episodes: int, split: str, is_greedy: bool
) -> dict[str, float]:
    """Return the mean metrics of the first episode in each row.

    Episodes that end soon would be counted more often if rows played on: the successful ones.
    """
    env = make_env(settings, episodes, None, split=split)
    choices, random = Choices(sizes_of(env)), torch.Generator().manual_seed(0)
    seen = rows_of(env.reset(seed=FIRST))
    found: dict[int, Any] = {}
    while len(found) < episodes:
        scores = policy(seen)
        action = choices.best(scores) if is_greedy else choices.draw(scores, random)
        outcome = env.step(in_space(action, env))
        seen = rows_of(outcome.observation)
        for match, metrics in zip(outcome.ended, outcome.metrics, strict=True):
            found.setdefault(match, metrics.mean(axis=0))
    means = np.mean(list(found.values()), axis=0)
    return dict(zip(env.arena.metrics, means.tolist(), strict=True))
