"""Time to make, store and read maps of 40 to 2,000 m on one core, compiled, and their memory."""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeVar
from unittest.mock import patch

import typer
from benchmarks.report import Figure, JsonFile, publish
from rich.console import Console
from rich.progress import track

from wildscav_engine.maps import generate_map
from wildscav_engine.maps.cache import load_cached, store
from wildscav_engine.maps.levels import LEVELS
from wildscav_engine.specs.map_spec import MapConfig

WARM_UP_SEED = 999
ENVIRONMENT = dict(os.environ)  # with the usual cache folder for compiled code
Made = TypeVar("Made")

# Runs in a process of its own, so that nothing else counts.
MEMORY = """
import resource
from wildscav_engine.maps import generate_map
from wildscav_engine.specs.map_spec import MapConfig
game_map = generate_map(MapConfig(size={size}, houses={houses}, storeys=(2, 3)), 0)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024, game_map.memory)
"""


class Case(NamedTuple):
    """Maps of one kind."""

    name: str
    config: MapConfig
    seeds: int


def case(size: int, houses: int, density: str, seeds: int) -> Case:
    """Return maps of a size in m with houses of two or three storeys."""
    config = MapConfig.model_validate({"size": size, "houses": houses, "density": density, "storeys": (2, 3)})
    return Case(f"{size} m, {houses} houses, {density} density", config, seeds)


WARM_UP = Case("level expert", LEVELS["expert"], 1)  # has all pieces
CASES = (
    case(40, 1, "low", 7),
    case(100, 4, "low", 7),
    case(200, 8, "low", 7),
    Case("level hard", LEVELS["hard"], 7),
    Case("level expert", LEVELS["expert"], 7),
    case(500, 15, "low", 5),
    case(500, 15, "high", 5),
    case(1000, 40, "low", 3),
    case(2000, 80, "low", 1),
)
SIZES = tuple(case for case in CASES if case.config.density == "low" and case.config.storeys == (2, 3))


class Stopwatch:
    """Measured seconds, by the name of the measured work, in the order of first use."""

    def __init__(self) -> None:
        self.taken: dict[str, list[float]] = defaultdict(list)

    def time(self, what: str, work: Callable[[], Made]) -> Made:
        """Do some work and record how long it takes."""
        started = time.perf_counter()
        made = work()
        self.taken[what].append(time.perf_counter() - started)
        return made

    def figures(self, name: str) -> list[Figure]:
        """Return the medians, with their ranges."""
        return [
            Figure(f"{name}: {what}", statistics.median(taken), "s", spread(taken))
            for what, taken in self.taken.items()
        ]


def spread(taken: Sequence[float]) -> str:
    """Describe a median: the number of measurements and their range."""
    if len(taken) == 1:
        return "once"
    return f"median of {len(taken)}, {min(taken):.4f} to {max(taken):.4f}"


def measure(watch: Stopwatch, config: MapConfig, seed: int) -> None:
    """Generate one map, store it, and read it."""
    game_map = watch.time("made", lambda: generate_map(config, seed))
    watch.time("kept on disk", lambda: store(game_map))
    watch.time("read from disk", lambda: load_cached(game_map.spec))


def memory(config: MapConfig) -> tuple[float, float]:
    """Return the peak memory of a process that makes a map, and that of the map, MB."""
    code = MEMORY.format(size=int(config.size), houses=config.houses)
    done = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True, env=ENVIRONMENT
    )
    peak, taken = (int(number) / 1e6 for number in done.stdout.split())
    return peak, taken


def main(json_file: JsonFile = None) -> None:
    """Measure and print."""
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    figures = []
    measure(Stopwatch(), WARM_UP.config, WARM_UP_SEED)  # chooses the folder of compiled code, too
    with tempfile.TemporaryDirectory() as cache, patch.dict(os.environ):
        os.environ["WILDSCAV_CACHE_DIR"] = cache  # where maps are cached from now on
        for name, config, seeds in track(CASES, "Making maps", console=Console(stderr=True), transient=True):
            watch = Stopwatch()
            for seed in range(seeds):
                measure(watch, config, seed)
            figures += watch.figures(name)
    # Measured last, so that nothing needs compiling, which also takes memory.
    for name, config, _ in SIZES:
        peak, taken = memory(config)
        figures.append(Figure(f"{name}: peak memory", peak, "MB", "of a process"))
        figures.append(Figure(f"{name}: memory", taken, "MB", "of the map"))
    publish("Maps: seconds on one core, after compilation", figures, json_file)


if __name__ == "__main__":
    typer.run(main)
