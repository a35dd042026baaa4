"""What sensors that see agents and boxes cost in vector environments, beside what sees only the map."""

import statistics
import time
from typing import Any

import typer
from benchmarks.report import Figure, JsonFile, publish

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
    taken = []
    for _ in range(REPEATS + 1):
        started = time.perf_counter()
        for action in actions:
            env.step(action)
        taken.append((time.perf_counter() - started) * 1e6 / (STEPS * MATCHES))
    env.close()
    low, high = min(taken[1:]), max(taken[1:])
    return Figure(f"{track}, {name}", statistics.median(taken[1:]), "µs", f"{low:.1f} to {high:.1f}")


def main(json: JsonFile = None) -> None:
    """Measure and print the time of a step for each of 64 matches of one learner."""
    figures = [figure(track, name) for track in TRACKS for name in SENSORS]
    publish(f"a step of {MATCHES} × 1, for each match", figures, json)


if __name__ == "__main__":
    typer.run(main)
