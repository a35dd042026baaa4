"""The tables and the learning curves of ``paper.py`` and ``paper_teams.py``, from their results."""

import statistics
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks.learning.result_files import results_in

from wildscav_training.trials import rate, wilson

# Success rate and episode length with its standard deviation, from the paper's table of navigation.
PAPER = {
    101: {"A3C": (0.73, 219.4, 132.8), "PPO": (0.69, 228.4, 140.1), "IMPALA": (0.27, 330.9, 124.4)},
    102: {"A3C": (0.90, 185.2, 111.5), "PPO": (0.90, 170.6, 115.0), "IMPALA": (0.29, 330.5, 119.8)},
    103: {"A3C": (0.96, 158.2, 85.4), "PPO": (0.97, 87.5, 73.6), "IMPALA": (0.82, 136.8, 130.8)},
    104: {"A3C": (0.96, 118.8, 77.9), "PPO": (0.99, 63.9, 45.4), "IMPALA": (0.86, 109.5, 122.5)},
    8: {"A3C": (0.71, 255.9, 126.9), "PPO": (0.66, 283.1, 118.6), "IMPALA": (0.19, 354.1, 105.0)},
    14: {"A3C": (0.74, 239.6, 124.3), "PPO": (0.62, 284.0, 121.7), "IMPALA": (0.23, 353.4, 97.8)},
}
# Supplies of a team of four in three minutes, and the length of an episode of capture, both on map 101.
PAPER_TEAMS = {
    "gathering": {"A3C": (49.49, 18.67), "PPO": (98.92, 52.62), "IMPALA": (91.68, 45.90)},
    "capture": {"A3C": (143.18, 122.71), "PPO": (94.69, 98.55), "IMPALA": (251.58, 166.72)},
}
TEAM_COLUMNS = {"gathering": "boxes | supplies", "capture": "episode length | success"}
HEAD = "| map | agent | success | episode length | seeds | steps | CPU s |\n|---|---|---|---|---|---|---|\n"
TITLES = {"sampled": "trained", "deterministic": "trained, greedy"}
COLUMNS = 3
EPISODES = 50  # of a point of one run
FEW = 2  # seeds, from which no interval over seeds can be drawn that says anything
QUANTILES = {3: 4.30, 4: 3.18, 5: 2.78}  # of Student's t by the number of seeds, for 95 % intervals
NORMAL = 2.5  # the same for more seeds, on the safe side


def table(folder: Path) -> str:
    """Return the rows of all maps that have results, in Markdown."""
    runs = results_in(folder)
    lines = [HEAD]
    for number in PAPER:
        here = [run for run in runs if run["map"] == number]
        lines += rows_of(
            number, [run for run in here if "seed" in run], [run for run in here if "seed" not in run]
        )
    return "".join(lines)


def rows_of(number: int, trained: Sequence[Any], untrained: Sequence[Any]) -> list[str]:
    """Return the rows of a map: runs of training, the paper's, and agents without training."""
    if not trained and not untrained:
        return []
    rows = [trained_row(trained, choose) for choose in TITLES if trained]
    rows += [
        f"| | the paper's {name} | {100 * success:.0f} % | {length} ± {spread} | | | |"
        for name, (success, length, spread) in PAPER[number].items()
    ]
    rows += [
        f"| | `{name}` | {rate(list(map(bool, score['success'])))} | {spread_of([score])} | | | |"
        for run in untrained
        for name, score in run["scores"].items()
    ]
    return [f"{row}\n" for row in (f"| {number:03} {rows[0][2:]}", *rows[1:])]


def trained_row(runs: Sequence[Mapping[str, Any]], choose: str) -> str:
    """Return the row of all seeds: with one seed its interval, else mean and deviation over the seeds."""
    scores = [run["scores"][choose] for run in runs]
    means = [100.0 * statistics.fmean(score["success"]) for score in scores]
    if len(runs) == 1:
        success = rate(list(map(bool, scores[0]["success"])))
    else:
        success = f"{statistics.fmean(means):.1f} ± {statistics.stdev(means):.1f} %"
    seconds = statistics.fmean(run["cpu_seconds"] for run in runs)
    cells = f"{len(runs)} | {runs[0]['steps']:,} | {seconds:.0f}"
    return f"| | {TITLES[choose]} | {success} | {spread_of(scores)} | {cells} |"


def spread_of(scores: Sequence[Mapping[str, Any]], name: str = "length") -> str:
    """Return the mean and the standard deviation of a number over all episodes, as the paper does."""
    every = [value for score in scores for value in score[name]]
    return f"{statistics.fmean(every):.1f} ± {statistics.stdev(every):.1f}"


def team_table(folder: Path) -> str:
    """Return the tables of gathering and capture with all results, in Markdown."""
    runs = results_in(folder)
    return "\n".join(team_rows(task, [run for run in runs if run["task"] == task]) for task in PAPER_TEAMS)


def team_rows(task: str, runs: Sequence[Any]) -> str:
    """Return the table of a task: runs of training, the paper's, and agents without training."""
    learned = [run for run in runs if "seed" in run]
    rows = [f"| {task}, 101 | {TEAM_COLUMNS[task]} | episodes | seeds | steps | CPU s |\n{7 * '|---'}|\n"]
    for choose in TITLES if learned else ():
        seconds = statistics.fmean(run["cpu_seconds"] for run in learned)
        effort = f"{len(learned)} | {learned[0]['steps']:,} | {seconds:.0f}"
        cells = team_cells(task, [run["scores"][choose] for run in learned])
        rows.append(f"| {TITLES[choose]} | {cells} | {effort} |\n")
    # It counted boxes in gathering, and steps in capture.
    paper = PAPER_TEAMS[task].items()
    rows += [f"| the paper's {name} | {mean} ± {spread} | | | | | |\n" for name, (mean, spread) in paper]
    others = [(name, score) for run in runs if "seed" not in run for name, score in run["scores"].items()]
    rows += [f"| `{name}` | {team_cells(task, [score])} | | | |\n" for name, score in others]
    return "".join(rows)


def team_cells(task: str, scores: Sequence[Mapping[str, Any]]) -> str:
    """Return the figures of a team, over all episodes of all seeds, and the number of those."""
    count = sum(len(score["length"]) for score in scores)
    if task == "gathering":
        return f"{spread_of(scores, 'boxes')} | {spread_of(scores, 'supplies')} | {count}"
    success = rate([bool(one) for score in scores for one in score["success"]])
    return f"{spread_of(scores)} | {success} | {count}"


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
