"""The ladder of levels: what agents reach on each, and whether a level is harder than the one before.

    python -m benchmarks.strength.levels --picture docs/images/levels.png

plays the same matches on the test maps of a level with each agent, as ``wildscav baselines`` does, and with
``tuned``: a policy that ``wildscav train`` trained on the level's maps for training. It adds what is not yet
in the folder of results, and prints the tables of all that is there; with ``--agents ''`` it only does that.
``--track gathering`` and ``--track battle`` do the same for the ladders of these tracks; the picture shows
all three. With ``--seed 1``, another ``tuned`` joins those that are there. Where the score is no rate, it is
also given as a share of what the reference carries on easy.
"""

import itertools
import math
import statistics
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import typer
from benchmarks.learning.result_files import add, results_in

from wildscav.cli.init import write_files
from wildscav.policy.networks import Choose
from wildscav_engine.envs import SeatController
from wildscav_engine.maps.levels import LEVELS, Level
from wildscav_evaluator.scores.overall import across_tracks
from wildscav_training.learning.run import train
from wildscav_training.learning.settings import TrainingSettings, changed, preset_settings
from wildscav_training.learning.start import Start, read_start
from wildscav_training.learning.submission import policy_submission
from wildscav_training.opponents import named_agent
from wildscav_training.trials import SUCCESS, half_width, matches_on, mean, play, rate, wilson

ROOT = Path(__file__).parents[2]
RESULTS = ROOT / "benchmarks/learning/results/levels"
TUNED = "tuned"  # the agent that is trained on each level
AGENTS = {  # the last is no agent to compare levels by
    "navigation": (
        *("straight", "homing", "navigator", "mapper"),
        *("learned-navigator", "cloned-navigator", TUNED, "oracle"),
    ),
    "gathering": ("homing", "hunter", "learned-scavenger", TUNED, "scavenger", "random"),
    "battle": ("homing", "hunter", "scavenger", "learned-commando", TUNED, "commando", "random"),
}
REFERENCE = "homing"  # has the score 1, where 0 is that of ``random``
STEPS = 1_000_000
MARKS = "x^vDsPo*<>phdX"  # of agents in the picture
WALLS = {"channels": 2, "azimuths": 32, "range": 8}
GATHERER: dict[str, Any] = {"to_supplies": {}, "to_hot_spot": {}, "lidar": WALLS}


class Recipe(NamedTuple):
    """How ``tuned`` learns and plays a track."""

    options: dict[str, Any]  # of the environment
    hyperparameters: dict[str, Any]  # those that differ from the preset "tuned"
    choose: Choose = Choose.SAMPLED
    agent: Path | None = None  # what plays the policy, if not the policy alone
    begins_easy: bool = False  # whether it learns on easy for the first half of the steps


# A policy learns more from few steps by many small updates.
FEW_STEPS = {"matches": 32, "epochs": 10, "learning_rate": 0.0005, "entropy": 0.001}
# Without it, a policy stays at boxes behind walls.
WITH_MEMORY = ROOT / "submissions/learned-scavenger/agent.py"
TRAINING = {
    "navigation": Recipe({"random_maps": 64, "time_limit": 120, "frames_per_action": 15}, {}),
    "gathering": Recipe(
        {"preset": "ladder-gathering-v2", "random_maps": 256, "frames_per_action": 10, "sensors": GATHERER},
        FEW_STEPS,
        Choose.DETERMINISTIC,
        WITH_MEMORY,
    ),
    "battle": Recipe(
        {
            "preset": "ladder-battle-v2",
            "random_maps": 256,
            "frames_per_action": 10,
            "sensors": {"sights": {}, **GATHERER},
            "rewards": {"supply_found": 1},
        },
        FEW_STEPS,
        Choose.DETERMINISTIC,
        WITH_MEMORY,
        begins_easy=True,  # where others are quicker from the start, it does not learn to go to hot spots
    ),
}

WHOLE = partial(mean, digits=0)
SCORES = {
    "navigation": {SUCCESS: rate, "spl": mean},
    "gathering": {"supplies": WHOLE},
    "battle": {"supplies": WHOLE, "kills": WHOLE},
}

Results = Mapping[tuple[str, str], Any]  # by level and agent


def trained_on(track: str, level: Level, seed: int, out: Path) -> SeatController:
    """Return a policy as a submission; it is trained, or its training goes on, unless that is done."""
    recipe, folder = TRAINING[track], out if track == "navigation" else out / track
    if recipe.begins_easy:
        start, _ = learned(track, "easy", seed, STEPS // 2, folder / "first-half")
        run, settings = learned(track, level, seed, STEPS // 2, folder, read_start(start / "policy.npz"))
    else:
        run, settings = learned(track, level, seed, STEPS, folder)
    files = policy_submission(run, settings, f"tuned-{level}", recipe.choose)
    if recipe.agent is not None:
        files["agent.py"] = recipe.agent.read_bytes()
    write_files(run / "submission", files)
    return named_agent(str(run / "submission"))


def learned(
    track: str, level: Level, seed: int, steps: int, folder: Path, start: Start | None = None
) -> tuple[Path, TrainingSettings]:
    """Train a policy on a level; return the folder of its run, and the settings."""
    recipe = TRAINING[track]
    hyperparameters, options = preset_settings("tuned", track, {"level": level, **recipe.options})
    hyperparameters = changed(hyperparameters, recipe.hyperparameters)
    settings = TrainingSettings(track, options, steps, seed, hyperparameters, start=start)
    run = folder / level / f"seed-{seed}"
    train(settings, run, lambda _: None, resume=True, episodes=1)
    return run, settings


def measured(track: str, level: Level, name: str, seed: int, matches: int, out: Path) -> dict[str, Any]:
    """Let an agent play, and return its scores in each match."""
    agent = trained_on(track, level, seed, out) if name == TUNED else named_agent(name)
    trials = [play(agent, spec) for spec in matches_on(track, level, matches)]
    scores = {score: [round(trial.metrics[score], 4) for trial in trials] for score in SCORES[track]}
    act_time = statistics.fmean(trial.act_time for trial in trials)
    return {"level": level, "agent": name, "milliseconds": round(1000.0 * act_time, 2), **scores}


def table(results: Results, track: str, score: str, shown: Callable[[Sequence[float]], str]) -> str:
    """Return what each agent reaches on each level, in Markdown."""
    agents = [agent for agent in AGENTS[track] if any(agent == played for _, played in results)]
    lines = [
        "",
        f"| {score} | {' | '.join(f'`{agent}`' for agent in agents)} |",
        "|---" * (len(agents) + 1) + "|",
    ]
    for level in LEVELS:
        found = [results.get((level, agent)) for agent in agents]
        cells = ["" if one is None else shown(one[score]) for one in found]
        lines.append(f"| {level} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def normalized(results: Results) -> Results:
    """Return the supplies of agents on a scale on which, on easy, ``random`` has 0 and the reference 1."""
    low, high = (statistics.fmean(results["easy", name]["supplies"]) for name in ("random", REFERENCE))
    return {
        which: together(
            [{"supplies": [(each - low) / (high - low) for each in run["supplies"]]} for run in one["runs"]]
        )
        for which, one in results.items()
    }


def together(runs: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return the scores of several trainings of an agent as one result."""
    scores = runs[0].keys() - {"level", "agent", "milliseconds"}
    return {"runs": runs, **{score: [each for run in runs for each in run[score]] for score in scores}}


def seeds_table(results: Results, score: str) -> str:
    """Return what ``tuned`` reaches over its seeds, in Markdown, with bootstrap intervals.

    The interquartile mean is that of all matches; the intervals resample the matches of each seed.
    """
    lines = ["", f"| `{TUNED}`, {score} | seeds | mean of each | mean | IQM | falls by |", "|---" * 6 + "|"]
    last = None
    for level in LEVELS:
        if one := results.get((level, TUNED)):
            runs = [run[score] for run in one["runs"]]
            mean_of_all, middle = across_tracks(runs)
            means = ", ".join(f"{statistics.fmean(run):.2f}" for run in runs)
            shown = [
                f"{each.value:.2f} ({each.low:.2f} to {each.high:.2f})" for each in (mean_of_all, middle)
            ]
            falls = "" if last is None else f"{last - mean_of_all.value:.2f}"
            lines.append(f"| {level} | {len(runs)} | {means} | {' | '.join(shown)} | {falls} |")
            last = mean_of_all.value
    return "\n".join(lines) + "\n"


def fall(easier: Sequence[float], harder: Sequence[float], score: str) -> tuple[float, float, float]:
    """Return how much lower a mean is on the harder level, with the 95 % interval.

    Of rates, it is Newcombe's: "Interval estimation for the difference between independent proportions",
    Statistics in Medicine 17 (1998), method 10.
    """
    first, second = statistics.fmean(easier), statistics.fmean(harder)
    if score != SUCCESS:
        down = up = math.hypot(half_width(easier), half_width(harder))
    else:
        (low, high), (lowest, highest) = wilson(first, len(easier)), wilson(second, len(harder))
        down, up = math.hypot(first - low, highest - second), math.hypot(high - first, second - lowest)
    return first - second, first - second - down, first - second + up


def steps_table(results: Results, track: str) -> str:
    """Return how far agents fall from level to level where the interval excludes 0, in Markdown.

    The second score, such as SPL, is left out where the first says it already.
    """
    digits = 2 if track == "navigation" else 0
    lines = ["", "| from | to | falls |", "|---|---|---|"]
    for easier, harder in itertools.pairwise(LEVELS):
        falls = []
        for agent in AGENTS[track][:-1]:
            pair = results.get((easier, agent)), results.get((harder, agent))
            for score in SCORES[track] if None not in pair else ():
                by, low, high = fall(*(one[score] for one in pair), score)
                if low > 0.0 or high < 0.0:
                    falls.append(f"`{agent}` {score} {by:.{digits}f} ({low:.{digits}f} to {high:.{digits}f})")
                    break
        lines.append(f"| {easier} | {harder} | {', '.join(falls)} |")
    return "\n".join(lines) + "\n"


def results_of(track: str) -> Results:
    """Return all that was played on a track."""
    found: dict[tuple[str, str], list[Any]] = {}
    for one in results_in(folder_of(track)):
        found.setdefault((one["level"], one["agent"]), []).append(one)
    return {which: together(runs) for which, runs in found.items()}


def folder_of(track: str) -> Path:
    """Return where the results of a track are."""
    return RESULTS if track == "navigation" else RESULTS / track


def draw(picture: Path) -> None:
    """Draw what each agent reaches over the levels of each track, with 95 % intervals."""
    from matplotlib import pyplot as plt

    figure, panels = plt.subplots(1, len(AGENTS), figsize=(12.0, 4.4), layout="constrained", sharey=True)
    for axes, track in zip(panels, AGENTS, strict=True):
        draw_track(axes, track)
    handles = {
        text: line for axes in panels for line, text in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    figure.legend(handles.values(), handles, loc="outside right center", fontsize=8, frameon=False)
    figure.savefig(picture, dpi=110)


def draw_track(axes: Any, track: str) -> None:
    """Draw the panel of a track."""
    from matplotlib import colormaps

    results, score, title = results_of(track), SUCCESS, "targets reached, %"
    if track != "navigation":
        results, score = normalized(results), "supplies"
        title = f"supplies, % of those of {REFERENCE} on easy"
    names = list(dict.fromkeys(itertools.chain(*AGENTS.values())))
    for agent in AGENTS[track]:
        places = [place for place, level in enumerate(LEVELS) if (level, agent) in results]
        if agent == "random" or not places:
            continue
        found = [results[list(LEVELS)[place], agent][score] for place in places]
        color, marker = colormaps["tab20"](names.index(agent)), MARKS[names.index(agent)]
        middles = [100.0 * statistics.fmean(scores) for scores in found]
        axes.plot(places, middles, label=agent, color=color, marker=marker)
        bounds = [bounds_of(scores, score) for scores in found]
        low, high = ([100.0 * bound[side] for bound in bounds] for side in (0, 1))
        axes.fill_between(places, low, high, alpha=0.12, color=color, linewidth=0)
    axes.set_xticks(range(len(LEVELS)), LEVELS, rotation=45)
    axes.set_title(f"{track}: {title}", fontsize=9)
    axes.grid(alpha=0.3)


def bounds_of(scores: Sequence[float], score: str) -> tuple[float, float]:
    """Return the 95 % interval of a mean."""
    middle, reach = statistics.fmean(scores), half_width(scores)
    return wilson(middle, len(scores)) if score == SUCCESS else (middle - reach, middle + reach)


def main(
    levels: Annotated[str, typer.Option(help="Levels to play, separated by commas.")] = ",".join(LEVELS),
    track: Annotated[Literal["navigation", "gathering", "battle"], typer.Option(help="The track.")] = (
        "navigation"
    ),
    agents: Annotated[
        str | None, typer.Option(help="Agents to add, separated by commas.", show_default="all")
    ] = None,
    matches: Annotated[int, typer.Option(help="Matches of each agent on a level.", min=2)] = 100,
    seed: Annotated[int, typer.Option(help="Of the training of tuned.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder of the trainings.")] = Path("out/levels"),
    picture: Annotated[Path | None, typer.Option(help="File for the picture.")] = None,
) -> None:
    """Play what is missing; print the tables."""
    chosen: list[Any] = [level for level in LEVELS if level in levels.split(",")]
    for level in chosen:
        for name in AGENTS[track] if agents is None else filter(None, agents.split(",")):
            file = f"{level}-{name}-{seed}.json" if name == TUNED and seed else f"{level}-{name}.json"
            add(
                folder_of(track) / file,
                lambda level=level, name=name: measured(track, level, name, seed, matches, out),
            )
    results = results_of(track)
    for score, shown in SCORES[track].items():
        sys.stdout.write(table(results, track, score, shown))
    if track == "navigation":
        sys.stdout.write(seeds_table(results, SUCCESS))
    else:
        of_easy = normalized(results)
        sys.stdout.write(table(of_easy, track, "supplies", mean) + seeds_table(of_easy, "supplies"))
    sys.stdout.write(steps_table(results, track))
    if picture is not None:
        draw(picture)


if __name__ == "__main__":
    typer.run(main)
