"""Time to lay out, explore, store and read maps of 40 to 2,000 m on one core, compiled, and their memory."""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple, TypeVar
from unittest.mock import patch

import numpy as np
import typer
from benchmarks.report import Figure, JsonFile, publish
from rich.console import Console
from rich.progress import track

from wildscav_engine.geometry.world import World, build_world
from wildscav_engine.maps import generate_map
from wildscav_engine.maps.cache import load_cached, store
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.ground.terrain import water_of_cells
from wildscav_engine.maps.layout import Layout, lay_out
from wildscav_engine.maps.levels import LEVELS
from wildscav_engine.maps.locations import Places, choose_places
from wildscav_engine.maps.walk import NavGraph, build_graph, find_path
from wildscav_engine.specs.map_spec import MapConfig

WARM_UP_SEED = 999
ENVIRONMENT = dict(os.environ)  # with the usual cache folder for compiled code
PATHS = 40  # between random places of each map
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


def index(layout: Layout) -> World:
    """Build the world of a layout, with its spatial index."""
    terrain = layout.terrain
    water = water_of_cells(terrain.heights, terrain.water_level)
    return build_world(terrain.corner, terrain.heights, water, layout.solids, np.zeros((0, 3)))


def explore(world: World, layout: Layout, seed: int) -> tuple[NavGraph, Places]:
    """Find the reachable part of a map, and choose the places of the map there."""
    graph = build_graph(world)
    return graph, choose_places(graph, layout.houses, np.array(layout.solid_house, np.int16), seed)


def measure(watch: Stopwatch, config: MapConfig, seed: int) -> None:
    """Generate one map in steps and as a whole, store it, and find paths in it."""
    layout = watch.time("laid out", lambda: lay_out(config, seed))
    world = watch.time("indexed", lambda: index(layout))
    graph, places = watch.time("reachability", lambda: explore(world, layout, seed))
    game_map = watch.time("the whole of generate_map", lambda: generate_map(config, seed))
    watch.time("kept on disk", lambda: store(game_map))
    watch.time("read from disk", lambda: load_cached(game_map.spec))
    find_paths(watch, game_map, graph, np.concatenate([places.ground, places.high, places.indoor]))


def find_paths(watch: Stopwatch, game_map: GameMap, graph: NavGraph, places: np.ndarray) -> None:
    """Find paths between random places of a map."""
    random = np.random.default_rng(game_map.spec.seed)
    for start, end in places[random.integers(len(places), size=(PATHS, 2))]:
        if watch.time("shortest path", partial(find_path, graph, start, end)) is None:
            raise RuntimeError(f"no path from {start} to {end} in {game_map.spec}")


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
