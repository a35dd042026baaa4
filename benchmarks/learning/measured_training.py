"""Training with a learning curve, for the benchmarks of learning; times do not count the measuring."""

import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from benchmarks.report import machine

from wildscav_training.learning.ppo import PPO
from wildscav_training.learning.settings import TrainingSettings

EARLY, POINTS = (0, 1, 2, 3), 6  # of a learning curve: after so many rollouts, and so many evenly
WAYS = ("sampled", "deterministic")

# From a policy, its run, a number of episodes and the way to choose actions to the episodes' numbers by name.
Play = Callable[[Any, TrainingSettings, int, str], Mapping[str, Sequence[float]]]


def trained(
    settings: TrainingSettings, play: Play, of_curve: str, episodes: tuple[int, int]
) -> dict[str, Any]:
    """Train a policy and measure it; return what JSON can store.

    The curve has the means of one number by its name. There are so many episodes of each of its points, and
    of each score at the end.
    """

    def point() -> tuple[int, float]:
        found = play(learner.policy, settings, episodes[0], "sampled")
        return learner.steps, statistics.fmean(found[of_curve])

    learner = PPO(settings)
    cpu = wall = 0.0
    points = {*EARLY, *(-(-learner.total * place // POINTS) for place in range(1, POINTS + 1))}
    curve = [point()]
    while learner.rollouts < learner.total:
        cpu_start, wall_start = time.process_time(), time.monotonic()
        learner.iterate()
        cpu, wall = cpu + time.process_time() - cpu_start, wall + time.monotonic() - wall_start
        if learner.rollouts in points:
            curve.append(point())
    return {
        "map": settings.options.get("map"),
        "seed": settings.seed,
        "steps": learner.steps,
        "cpu_seconds": round(cpu, 1),
        "wall_seconds": round(wall, 1),
        "machine": {key: value for key, value in machine().items() if key in {"processor", "cores"}},
        "curve": curve,
        "scores": {way: dict(play(learner.policy, settings, episodes[1], way)) for way in WAYS},
    }
