"""How good a policy is: the mean metrics of episodes that it has not met in training."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from wildscav_training.learning.environment import make_env, sizes_of
from wildscav_training.learning.ppo import Choices, in_space, rows_of
from wildscav_training.learning.settings import TrainingSettings

FIRST = 2**63  # seeds of evaluations, above those of training
WAYS = tuple((split, choose) for split in ("train", "test") for choose in ("sampled", "deterministic"))


class Score(NamedTuple):
    """The mean metrics of one way to play on one split."""

    split: str  # "train": maps of training, other episodes; "test": other maps as well
    choose: str  # "sampled" or "deterministic"
    episodes: int
    metrics: Mapping[str, float]  # means by name


def evaluate(
    policy: Any, settings: TrainingSettings, episodes: int, tell: Callable[[int], None] = lambda _: None
) -> list[Score]:
    """Play a policy, from rows (N, n) to scores (N, C), in all WAYS, without curriculum.

    ``tell`` gets how many matches have ended.
    """
    scores = []
    for done, (split, choose) in enumerate(WAYS):
        before = done * episodes
        names, played = play_episodes(
            policy, settings, episodes, split, choose, lambda ended, before=before: tell(before + ended)
        )
        scores.append(Score(split, choose, episodes, _means(names, played)))
    return scores


def _means(names: Sequence[str], played: NDArray[np.float64]) -> dict[str, float]:
    return dict(zip(names, played.mean(axis=0).tolist(), strict=True))


@torch.no_grad()  # type: ignore[untyped-decorator]
def play_episodes(
    policy: Any,
    settings: TrainingSettings,
    episodes: int,
    split: str,
    choose: str,
    tell: Callable[[int], None] = lambda _: None,
) -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """Return the names of the metrics (M,), and the metrics (E, M) of the first episode in each of E rows.

    Episodes that end soon would be counted more often if rows played on: the successful ones.

    Args:
        policy: From rows (N, n) to scores (N, C).
        episodes: E.
        split: "train" or "test".
        choose: "sampled" or "deterministic".
        tell: Called with the number of rows whose episode has ended, whenever it grows.
    """
    env = make_env(settings, episodes, None, split=split)
    choices, random = Choices(sizes_of(env)), torch.Generator().manual_seed(0)
    seen = rows_of(env.reset(seed=FIRST))
    found: dict[int, NDArray[np.float64]] = {}
    while len(found) < episodes:
        scores = policy(seen)
        action = choices.best(scores) if choose == "deterministic" else choices.draw(scores, random)
        outcome = env.step(in_space(action, env))
        seen = rows_of(outcome.observation)
        for match, metrics in zip(outcome.ended, outcome.metrics, strict=True):
            found.setdefault(match, metrics.mean(axis=0))
        if outcome.ended:
            tell(len(found))
    return tuple(env.arena.metrics), np.array([found[row] for row in range(episodes)])
