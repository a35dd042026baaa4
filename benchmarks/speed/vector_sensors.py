"""What sensors that see agents and boxes cost in vector environments, beside what sees only the map."""

from typing import Any

import numpy as np
import typer
from benchmarks.report import Figure, JsonFile, in_turns, many, publish

from wildscav_engine.envs.vector import VectorArena

MATCHES = 64
REPEATS = 15
STEPS = 8
TRACKS = ("navigation", "gathering", "battle")
SENSORS: dict[str, dict[str, Any]] = {
    "no sensor": {},
    "depth": {"depth": {}},
    "depth, moving": {"depth": {"moving": True}},
    "segmentation": {"segmentation": {}},
    "normals": {"normals": {}},
    "lidar": {"lidar": {}},
    "lidar, moving": {"lidar": {"moving": True}},
    "camera 84 × 84": {"camera": {"width": 84, "height": 84}},
}


def figure(track: str, name: str) -> Figure:
    """Measure the steps of a vector environment on the level normal."""
    env = VectorArena(track, MATCHES, level="normal", sensors=SENSORS[name])
    env.action_space.seed(0)
    actions = [env.action_space.sample() for _ in range(STEPS)]
    env.reset(seed=1)
    taken = (
        in_turns([many(lambda number: env.step(actions[number]), STEPS)], REPEATS) * 1e6 / (STEPS * MATCHES)
    )
    env.close()
    spread = f"{taken.min():.1f} to {taken.max():.1f}"
    return Figure(f"{track}, {name}", float(np.median(taken)), "µs", spread)


def main(json: JsonFile = None) -> None:
    """Measure and print the time of a step for each of 64 matches of one learner."""
    figures = [figure(track, name) for track in TRACKS for name in SENSORS]
    publish(f"a step of {MATCHES} × 1, for each match", figures, json)


if __name__ == "__main__":
    typer.run(main)
