"""How long maps take to make, after compilation."""

import statistics
import time

import typer
from report import Figure, JsonFile, publish

from wildscav_engine.maps import generate_map
from wildscav_engine.spec import MapConfig

SIZES = ((60, 2), (100, 4), (500, 15), (1000, 40))
REPEATS = 5


def seconds(config: MapConfig) -> list[float]:
    """Return how long maps of five seeds take."""
    generate_map(config, 999)
    taken = []
    for seed in range(REPEATS):
        started = time.perf_counter()
        generate_map(config, seed)
        taken.append(time.perf_counter() - started)
    return taken


def main(json_file: JsonFile = None) -> None:
    """Measure and print."""
    figures = []
    for size, houses in SIZES:
        taken = seconds(MapConfig(size=size, houses=houses))
        name = f"map of {size} × {size} m, {houses} houses"
        note = f"median of {REPEATS} seeds, {min(taken):.3f} to {max(taken):.3f}"
        figures.append(Figure(name, statistics.median(taken), "s", note))
    publish("Maps: seconds to make one", figures, json_file)


if __name__ == "__main__":
    typer.run(main)
