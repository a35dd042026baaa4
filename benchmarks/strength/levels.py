"""The ladder of levels: what agents reach on each, and whether a level is harder than the one before.

    python -m benchmarks.strength.levels --picture docs/images/levels.png

plays the same matches on the test maps of a level with each agent, as ``wildscav baselines`` does, and with
``tuned``: a policy that ``wildscav train`` trained on the level's maps for training. It adds what is not yet
in the folder of results, and prints the tables of all that is there; with ``--agents ''`` it only does that.
``--track gathering`` and ``--track battle`` do the same for the ladders of these tracks. With ``--seed 1``,
the matches of another ``tuned`` join those that are there.
"""

import itertools
import math
import statistics
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

import typer
from benchmarks.learning.result_files import add, results_in

from wildscav.cli.init import write_files
from wildscav.policy.networks import Choose
from wildscav_engine.envs import SeatController
from wildscav_engine.maps.levels import LEVELS, Level
from wildscav_training.learning.run import train
from wildscav_training.learning.settings import TrainingSettings, preset_settings
from wildscav_training.learning.submission import policy_submission
from wildscav_training.opponents import named_agent
from wildscav_training.trials import SUCCESS, half_width, matches_on, mean, play, rate, wilson

RESULTS = Path(__file__).parents[1] / "learning" / "results" / "levels"
TUNED = "tuned"  # the agent that is trained on each level
AGENTS = {  # the last is no agent to compare levels by
    "navigation": (
        *("straight", "homing", "navigator", "mapper"),
        *("learned-navigator", "cloned-navigator", TUNED, "oracle"),
    ),
    "gathering": ("homing", "hunter", "learned-scavenger", TUNED, "scavenger", "random"),
    "battle": ("homing", "hunter", "scavenger", "learned-commando", TUNED, "commando", "random"),
}
REFERENCES = {"gathering": "scavenger", "battle": "commando"}  # the score 1, where 0 is that of ``random``
STEPS = 1_000_000
GATHERER = {"to_supplies": {}, "to_hot_spot": {}, "lidar": {"channels": 2, "azimuths": 24}}
TRAINING: dict[str, dict[str, Any]] = {  # the environment of ``tuned``, as docs/training.md advises
    "navigation": {"random_maps": 64, "time_limit": 120, "frames_per_action": 15},
    "gathering": {"preset": "ladder-gathering", "frames_per_action": 10, "sensors": GATHERER},
    "battle": {
        "preset": "ladder-battle",
        "action_mode": "fine",
        "sensors": {"sights": {}, **GATHERER},
        "rewards": {"supplies": 0.02, "hit": 0.2, "kill": 1, "death": -1},
    },
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
    hyperparameters, options = preset_settings("tuned", track, {"level": level, **TRAINING[track]})
    settings = TrainingSettings(track, options, STEPS, seed, hyperparameters)
    run = (out if track == "navigation" else out / track) / level / f"seed-{seed}"
    train(settings, run, lambda _: None, resume=True, episodes=1)
    folder = run / "submission"
    write_files(folder, policy_submission(run, settings, f"tuned-{level}", Choose.SAMPLED))
    return named_agent(str(folder))


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


def normalized(results: Results, track: str) -> Results:
    """Return the supplies of agents on a scale of each level: 0 for ``random``, 1 for the reference."""
    scaled = {}
    for (level, agent), one in results.items():
        ends = [results.get((level, name)) for name in ("random", REFERENCES[track])]
        if None not in ends:
            low, high = (statistics.fmean(end["supplies"]) for end in ends if end)
            scaled[level, agent] = {"supplies": [(each - low) / (high - low) for each in one["supplies"]]}
    return scaled


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


def draw(results: Results, picture: Path) -> None:
    """Draw the success of each agent over the levels, with 95 % intervals."""
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(8.0, 4.4), layout="constrained")
    for agent, marker in zip(AGENTS["navigation"], "x^vDsPo*", strict=True):
        places = [place for place, level in enumerate(LEVELS) if (level, agent) in results]
        found = [results[list(LEVELS)[place], agent]["success"] for place in places]
        middles = [statistics.fmean(successes) for successes in found]
        bounds = [wilson(middle, len(one)) for middle, one in zip(middles, found, strict=True)]
        (line,) = axes.plot(places, [100.0 * each for each in middles], marker=marker, label=agent)
        low, high = ([100.0 * bound[side] for bound in bounds] for side in (0, 1))
        axes.fill_between(places, low, high, alpha=0.12, color=line.get_color(), linewidth=0)
    axes.set_xticks(range(len(LEVELS)), LEVELS)
    axes.set_ylabel("targets reached, %")
    axes.set_ylim(-2, 102)
    axes.grid(alpha=0.3)
    figure.legend(loc="outside right center", fontsize=8, frameon=False)
    figure.savefig(picture, dpi=110)


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
    folder = RESULTS if track == "navigation" else RESULTS / track
    for level in chosen:
        for name in AGENTS[track] if agents is None else filter(None, agents.split(",")):
            file = f"{level}-{name}-{seed}.json" if name == TUNED and seed else f"{level}-{name}.json"
            add(
                folder / file,
                lambda level=level, name=name: measured(track, level, name, seed, matches, out),
            )
    results: dict[tuple[str, str], Any] = {}
    for one in results_in(folder):
        known = results.setdefault((one["level"], one["agent"]), one)
        for score in SCORES[track] if known is not one else ():
            known[score] += one[score]  # of another training
    for score, shown in SCORES[track].items():
        sys.stdout.write(table(results, track, score, shown))
    if scaled := normalized(results, track) if track in REFERENCES else {}:
        sys.stdout.write(table(scaled, track, "supplies", mean))
    sys.stdout.write(steps_table(results, track))
    if picture is not None:
        draw(results, picture)


if __name__ == "__main__":
    typer.run(main)
