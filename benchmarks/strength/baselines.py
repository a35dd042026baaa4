"""How well agents find their way in a suite: success, SPL and their time for a step.

    python -m benchmarks.strength.baselines --where wild --matches 100

plays the same matches with each agent in this process, and compares each with the first by the difference
of their SPL, match by match. On the levels, ``wildscav baselines`` plays.
"""

import statistics
import sys
from collections.abc import Sequence
from typing import Annotated, Literal, NamedTuple

import numpy as np
import typer
from rich.progress import track

from wildscav_engine.maps.cache import map_of
from wildscav_engine.maps.walk import find_path
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.suites.suite import suite
from wildscav_training.opponents import named_agent
from wildscav_training.trials import SUCCESS, Trial, mean, play, rate

HEAD = ("agent", "success", "SPL", "SPL more than `{}`", "processor time a step")


class Way(NamedTuple):
    """The way of one episode."""

    path: float  # m, the shortest path
    straight: float  # m, the straight line


def episodes_of(track_name: str, suite_name: str, count: int) -> list[MatchSpec]:
    """Return matches of a suite on a track, evenly from rounds with the seeds 0, 1, 2 and so on."""
    specs: list[MatchSpec] = []
    seed = 0
    while len(specs) < count:
        specs += suite(track_name, suite_name, seed)
        seed += 1
    return specs[:: len(specs) // count][:count]


def way_of(spec: MatchSpec) -> Way:
    """Return the shortest way from the first seat's start to the target."""
    game_map = map_of(spec.map)
    batch = Batch([spec], [game_map])
    start, target = batch.state.agents.position[0, 0], batch.state.matches.target[0]
    path, offset = find_path(game_map.graph, start, target), target - start
    straight = float(np.sqrt(offset[0] ** 2 + offset[2] ** 2))
    return Way(path.length if path else np.inf, straight)


def said_of(ways: Sequence[Way]) -> str:
    """Return the medians of ways."""
    ratio = statistics.median(way.path / way.straight for way in ways)
    return f"median way {statistics.median(way.path for way in ways):.0f} m, {ratio:.2f} × the straight line"


def rows_of(played: dict[str, list[Trial]]) -> list[str]:
    """Return a row of the table for each agent."""
    first = [trial.metrics["spl"] for trial in next(iter(played.values()))]
    rows = []
    for name, trials in played.items():
        spl = [trial.metrics["spl"] for trial in trials]
        gain = "" if not rows else mean([own - other for own, other in zip(spl, first, strict=True)], "+")
        time_taken = 1000.0 * statistics.fmean(trial.act_time for trial in trials)
        success = rate([trial.metrics[SUCCESS] for trial in trials])
        rows.append(f"| `{name}` | {success} | {mean(spl)} | {gain} | {time_taken:.1f} ms |")
    return rows


def main(
    where: Annotated[Literal["official", "wild"], typer.Option(help="The suite.")] = "wild",
    track_name: Annotated[
        Literal["navigation", "capture"], typer.Option("--track", help="The track.")
    ] = "navigation",
    matches: Annotated[int, typer.Option(help="Number of matches.", min=1)] = 100,
    agents: Annotated[str, typer.Option(help="The agents, separated by commas.")] = (
        "homing,navigator,mapper,oracle"
    ),
) -> None:
    """Print the table."""
    players = {name: named_agent(name) for name in agents.split(",")}
    played: dict[str, list[Trial]] = {name: [] for name in players}
    ways = []
    for spec in track(episodes_of(track_name, where, matches), where):
        ways.append(way_of(spec))
        for name, agent in players.items():
            played[name].append(play(agent, spec))
    head = " | ".join(HEAD).format(next(iter(players)))
    lines = f"| {head} |", "|" + "---|" * len(HEAD), *rows_of(played)
    sys.stdout.write(f"{track_name}, {where}, {matches} matches, {said_of(ways)}\n\n")
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    typer.run(main)
