"""How well policies for navigation do on maps that they have never seen, by the number of maps of training.

    python -m benchmarks.learning.generalization --seeds 0,1,2 --picture docs/images/generalization.png

trains on 1, 10, 100 and 1,000 random maps of the levels normal and hard, and measures success and SPL on the
maps of training, in other episodes, and on 100 others, as Cobbe et al. did ("Leveraging Procedural Generation
to Benchmark Reinforcement Learning", 2020). It adds what is not yet in the folder of results, and prints the
table of all that is there; with ``--seeds ''`` it only does that. Maps take up to 6 GB of memory.
"""

import statistics
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import torch
import typer
from benchmarks.learning.paper import FRAMES, TIME_LIMIT
from benchmarks.learning.result_files import add, numbers, results_in

from wildscav_training.learning.evaluation import play_episodes
from wildscav_training.learning.ppo import PPO
from wildscav_training.learning.settings import TrainingSettings, preset_settings

RESULTS = Path(__file__).parent / "results" / "generalization"
LEVELS, COUNTS = ("normal", "hard"), (1, 10, 100, 1000)
STEPS, EPISODES, TEST_MAPS = 200_000, 100, 100
RESAMPLES = 2000
SCORES = {"success": ("targets reached, %", 100.0), "spl": ("SPL", 1.0)}  # with the best value
TITLES = {"train": "maps of training", "test": "unseen maps"}


def settings_of(level: str, maps: int, seed: int) -> TrainingSettings:
    """Return the run of a level and a number of maps."""
    options = {"level": level, "random_maps": maps, "time_limit": TIME_LIMIT, "frames_per_action": FRAMES}
    hyperparameters, options = preset_settings("tuned", "navigation", options)
    return TrainingSettings("navigation", options, STEPS, seed, hyperparameters)


def scores(policy: Any, settings: TrainingSettings, split: str) -> dict[str, list[float]]:
    """Return the successes and SPL of episodes by name, on maps of training or on others."""
    maps = settings.options["random_maps"] if split == "train" else TEST_MAPS
    with_spl = replace(settings, options={**settings.options, "random_maps": maps, "all_metrics": True})
    names, found = play_episodes(policy, with_spl, EPISODES, split, "sampled")
    return {name: np.round(found[:, names.index(name)], 4).tolist() for name in SCORES}


def trained(settings: TrainingSettings) -> dict[str, Any]:
    """Train a policy and measure it on both splits."""
    learner = PPO(settings)
    began = time.process_time()
    while learner.rollouts < learner.total:
        learner.iterate()
    seconds = time.process_time() - began
    return {
        "level": settings.options["level"],
        "maps": settings.options["random_maps"],
        "seed": settings.seed,
        "steps": learner.steps,
        "cpu_seconds": round(seconds, 1),
        "scores": {split: scores(learner.policy, settings, split) for split in TITLES},
    }


class Mean(NamedTuple):
    """A mean with its 95 % interval."""

    middle: float
    low: float
    high: float


def mean_of(runs: Sequence[Mapping[str, Any]], split: str, name: str) -> Mean:
    """Return the mean of a score; the interval is a bootstrap of the seeds, and of the episodes of each."""
    scores = np.array([run["scores"][split][name] for run in runs])  # (R, E)
    random, (count, episodes) = np.random.default_rng(0), scores.shape
    runs_drawn = random.integers(count, size=(RESAMPLES, count, 1))
    drawn = scores[runs_drawn, random.integers(episodes, size=(RESAMPLES, count, episodes))]
    low, high = np.percentile(drawn.mean(axis=(1, 2)), (2.5, 97.5))
    return Mean(float(scores.mean()), float(low), float(high))


def table(results: Sequence[Any]) -> str:
    """Return a row for each level and number of maps, in Markdown."""
    rows = ["| level | maps | seeds | success, trained | SPL | success, unseen | SPL | CPU s |\n"]
    rows.append(f"{8 * '|---'}|\n")
    for level, maps, runs in grouped(results):
        cells = []
        for split in TITLES:
            success, spl = (mean_of(runs, split, name) for name in SCORES)
            cells.append("{:.0f} % ({:.0f}–{:.0f})".format(*(100.0 * value for value in success)))
            cells.append("{:.2f} ({:.2f}–{:.2f})".format(*spl))
        seconds = statistics.fmean(run["cpu_seconds"] for run in runs)
        rows.append(f"| {level} | {maps:,} | {len(runs)} | {' | '.join(cells)} | {seconds:.0f} |\n")
    return "".join(rows)


def grouped(results: Sequence[Any]) -> list[tuple[str, int, list[Any]]]:
    """Return the runs of each level and number of maps that there are."""
    groups = [
        (level, maps, [run for run in results if (run["level"], run["maps"]) == (level, maps)])
        for level in LEVELS
        for maps in COUNTS
    ]
    return [group for group in groups if group[2]]


def draw(results: Sequence[Any], picture: Path) -> None:
    """Draw the scores on maps of training and on unseen ones over the number of maps, with 95 % intervals."""
    from matplotlib import pyplot as plt

    shape = {"figsize": (7.5, 5.0), "sharex": True, "sharey": "row", "layout": "constrained"}
    figure, grid = plt.subplots(len(SCORES), len(LEVELS), **shape)
    for row, (name, (title, best)) in zip(grid, SCORES.items(), strict=True):
        for level, axes in zip(LEVELS, row, strict=True):
            _draw_score(axes, [group for group in grouped(results) if group[0] == level], name, best)
            axes.set_ylim(0, 1.03 * best)
            axes.grid(alpha=0.3)
        row[0].set_ylabel(title)
    for level, top, bottom in zip(LEVELS, grid[0], grid[-1], strict=True):
        top.set_title(f"level {level}", fontsize=10)
        bottom.set_xlabel("maps of training")
    grid[0, 0].legend(loc="lower right", fontsize=8, frameon=False)
    figure.savefig(picture, dpi=110)


def _draw_score(axes: Any, groups: Sequence[tuple[str, int, Any]], name: str, best: float) -> None:
    """Draw a score of a level, in units of which the best is ``best``, with a line for each split."""
    for split, title in TITLES.items():
        means = [mean_of(runs, split, name) for _, _, runs in groups]
        middle, low, high = (best * np.array(column) for column in zip(*means, strict=True))
        where = [maps for _, maps, _ in groups]
        axes.plot(where, middle, marker="o", markersize=4, label=title)
        axes.fill_between(where, low, high, alpha=0.2)
    axes.set_xscale("log")


def main(
    levels: Annotated[str, typer.Option(help="Levels, separated by commas.")] = ",".join(LEVELS),
    seeds: Annotated[str, typer.Option(help="Seeds of the runs.")] = "0",
    out: Annotated[Path, typer.Option(help="Folder of the results.")] = RESULTS,
    picture: Annotated[Path | None, typer.Option(help="File for the plot.")] = None,
) -> None:
    """Train what is missing, and print the table."""
    torch.set_num_threads(1)
    runs = [(level, maps, seed) for seed in numbers(seeds) for level in levels.split(",") for maps in COUNTS]
    for level, maps, seed in runs:
        add(out / f"{level}-{maps}-seed-{seed}.json", partial(trained, settings_of(level, maps, seed)))
    results = results_in(out)
    sys.stdout.write(table(results))
    if picture is not None:
        draw(results, picture)


if __name__ == "__main__":
    typer.run(main)
