"""Agents of one match, and the size of its map."""

import functools
import time

import numpy as np
from benchmarks.report import in_turns
from benchmarks.speed import maps, steps

from wildscav_engine.maps import generate_map
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.specs.map_spec import MapSpec
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.map_making import make_map

HOUSES = {40: 1, 100: 4, 250: 8, 500: 15, 1000: 40, 2000: 80}
SMALL = 500  # m: maps up to this size are made three times
POOLED, POOL, BEFORE = 250, 40, 10  # m and number of the maps made in parallel; those made before it counts


def agents(seats: int) -> dict[str, float]:
    """Measure a battle on a square kilometre on one core, and reading its state from memory."""
    memory = steps.memory_of(Batch([steps.spec_on(steps.wilds(), "battle", seats)], [steps.wilds()]))
    return {
        "microseconds": steps.crowd_cost(seats),
        "memory_microseconds": 1e6 * memory / (bandwidth() * seats),
        "kilobytes": memory / 1000,
    }


@functools.cache
def bandwidth() -> float:
    """Return how many bytes one core reads from memory in a second."""
    numbers = np.ones(1 << 25)
    return float(numbers.nbytes / in_turns([numbers.max], 4, time.thread_time).min())


def map_size(size: int) -> dict[str, float]:
    """Measure how long a map takes to generate on one core, and the peak memory of a process for it.

    Maps of one size are also made by one and by two workers, as ``wildscav map make`` does.
    """
    config = maps.case(size, HOUSES[size], "low", 1).config
    generate_map(maps.WARM_UP.config, maps.WARM_UP_SEED)
    taken = []
    for _ in range(3 if size <= SMALL else 1):
        started = time.thread_time()
        generate_map(config, 0)
        taken.append(time.thread_time() - started)
    found = {"seconds": min(taken), "megabytes": maps.memory(config)[0]}
    if size == POOLED:
        found |= {f"maps_a_second_{workers}": _maps_a_second(workers) for workers in (1, 2)}
    return found


def _maps_a_second(workers: int) -> float:
    """Return how many maps some workers make in a second, once all of them have started."""
    config = maps.case(POOLED, HOUSES[POOLED], "low", POOL).config
    choices = [(MapSpec(config=config, seed=seed),) for seed in range(POOL)]
    made = LocalExecutor(workers).map(make_map, choices)
    for _ in range(BEFORE):
        next(made)
    started = time.perf_counter()
    return sum(1 for _ in made) / (time.perf_counter() - started)
