"""The learning curves of ``paper.py`` as a picture, from its folder of results."""

import statistics
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.learning.paper_table import PAPER
from benchmarks.learning.result_files import results_in

from wildscav_training.trials import wilson

COLUMNS = 3
EPISODES = 50  # of a point of one run
FEW = 2  # seeds, from which no interval over seeds can be drawn that says anything
QUANTILES = {3: 4.30, 4: 3.18, 5: 2.78}  # of Student's t by the number of seeds, for 95 % intervals
NORMAL = 2.5  # the same for more seeds, on the safe side


def draw(folder: Path, picture: Path) -> None:
    """Draw a curve for each map: the mean of all seeds in equal numbers of steps, and its 95 % interval."""
    from matplotlib import pyplot as plt

    runs = results_in(folder, "*-seed-*.json")
    numbers = [number for number in PAPER if any(run["map"] == number for run in runs)]
    columns = max(1, min(COLUMNS, len(numbers)))
    rows = max(1, -(-len(numbers) // columns))
    figure, grid = plt.subplots(
        rows, columns, figsize=(3.0 * columns, 2.6 * rows), sharey=True, squeeze=False, layout="constrained"
    )
    for axes in grid.flat[len(numbers) :]:
        axes.set_visible(False)
    for number, axes in zip(numbers, grid.flat, strict=False):
        draw_map(axes, number, [run for run in runs if run["map"] == number])
    for row in grid:
        row[0].set_ylabel("targets reached, %")
    figure.savefig(picture, dpi=110)


def draw_map(axes: Any, number: int, runs: Sequence[Any]) -> None:
    """Draw the curve of a map, and the best of the paper's three learners as a line."""
    thousands = [0.001 * steps for steps, _ in runs[0]["curve"]]
    points = [interval([run["curve"][point][1] for run in runs]) for point in range(len(thousands))]
    middles, lows, highs = ([100.0 * value for value in column] for column in zip(*points, strict=True))
    axes.fill_between(thousands, lows, highs, alpha=0.25, linewidth=0)
    axes.plot(thousands, middles, marker="o", markersize=3)
    best = 100.0 * max(success for success, *_ in PAPER[number].values())
    axes.axhline(best, color="0.5", linestyle="--", linewidth=1, label="the paper's best")
    axes.legend(loc="lower right", fontsize=8, frameon=False)
    seeds = "1 seed" if len(runs) == 1 else f"{len(runs)} seeds"
    axes.set_title(f"map {number:03}, {seeds}", fontsize=10)
    axes.set_xlabel("thousand steps")
    axes.set_ylim(-3, 103)
    axes.set_xlim(left=0)


def reach_of(means: Sequence[float]) -> float:
    """Return half of the 95 % interval of the mean over seeds (Student's t)."""
    return QUANTILES.get(len(means), NORMAL) * statistics.stdev(means) / len(means) ** 0.5


def interval(shares: Sequence[float]) -> tuple[float, float, float]:
    """Return the mean of a point and its 95 % interval: over seeds, or of the episodes of one or two."""
    middle = statistics.fmean(shares)
    if len(shares) <= FEW:
        return middle, *wilson(middle, len(shares) * EPISODES)
    reach = reach_of(shares)
    return middle, max(0.0, middle - reach), min(1.0, middle + reach)
