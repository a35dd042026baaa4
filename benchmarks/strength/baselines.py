"""How well the baselines of navigation find their way: success, SPL and their time for a step.

    python -m benchmarks.strength.baselines --where hard --matches 100

plays the same matches with each agent in this process, and compares each with the first by the difference
of their SPL, match by match. ``oracle`` knows the map.
"""

import statistics
import sys
import time
from collections.abc import Iterator, Sequence
from typing import Annotated, Literal, NamedTuple

import numpy as np
import typer
from rich.progress import track

from wildscav_engine.envs import SeatController
from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
from wildscav_engine.maps.cache import map_of
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.pools import random_maps
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.specs.actions import FIELDS
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.tracks.navigation import spl_of
from wildscav_evaluator.suites.suite import suite
from wildscav_training.opponents import Oracle, submission

Where = Literal["official", "hard", "wild"]
SURE = 1.96  # standard errors in a 95 % interval
HARD_TIME = 120.0  # s, of matches on maps of the level hard


class Played(NamedTuple):
    """One match of one agent."""

    success: bool
    spl: float
    act_time: float  # s of processor time a step, with its sensors


def player(name: str) -> SeatController:
    """Return an agent by its name: ``oracle``, or a submission."""
    return Oracle() if name == "oracle" else submission(name)


def play(agent: SeatController, spec: MatchSpec, game_map: GameMap) -> Played:
    """Let an agent play in the first seat of a match."""
    batch = Batch([spec], [game_map])
    match, seat = np.zeros(1, np.int64), np.zeros(1, np.int64)
    agent.begin(batch, match, seat)
    row = np.zeros((1, len(spec.seats), FIELDS), np.float32)
    steps, taken = 0, 0.0
    while not batch.state.matches.over[0]:
        began = time.process_time()
        row[0, 0] = agent.act(batch, match, seat)[0]
        taken += time.process_time() - began
        steps += 1
        batch.step(row)
    success = bool(batch.state.agents.reached[0].any())
    return Played(success, spl_of(MatchInBatch(batch, 0), [0]) if success else 0.0, taken / steps)


def spread(specs: Sequence[MatchSpec], count: int) -> list[MatchSpec]:
    """Return some matches, evenly from all."""
    return list(specs[:: len(specs) // count][:count])


def episodes_of(track_name: str, suite_name: str, count: int) -> list[MatchSpec]:
    """Return matches of a suite on a track, evenly from rounds with the seeds 0, 1, 2 and so on."""
    specs: list[MatchSpec] = []
    seed = 0
    while len(specs) < count:
        specs += suite(track_name, suite_name, seed)
        seed += 1
    return spread(specs, count)


def matches_on(where: Where, count: int) -> Iterator[tuple[MatchSpec, GameMap]]:
    """Yield matches of navigation and their maps."""
    if where != "hard":
        for spec in episodes_of("navigation", where, count):
            yield spec, map_of(spec.map)
        return
    pool = random_maps("hard", split="test", seed=0, size=count)
    for number in range(count):
        game_map = pool[number]
        yield MatchSpec(track="navigation", map=game_map.spec, seed=number, time_limit=HARD_TIME), game_map


def wilson(share: float, count: int) -> tuple[float, float]:
    """Return the 95 % interval of a success rate (Wilson 1927)."""
    middle = (share + SURE * SURE / (2 * count)) / (1 + SURE * SURE / count)
    reach = SURE / (1 + SURE * SURE / count)
    reach *= (share * (1 - share) / count + SURE * SURE / (4 * count * count)) ** 0.5
    return max(0.0, middle - reach), min(1.0, middle + reach)


def rate(successes: Sequence[bool]) -> str:
    """Return a success rate with its 95 % interval."""
    share = statistics.fmean(successes)
    low, high = wilson(share, len(successes))
    return f"{100.0 * share:.1f} % ({100.0 * low:.1f}–{100.0 * high:.1f})"


def mean(values: Sequence[float], sign: str = "") -> str:
    """Return a mean with its 95 % interval."""
    middle = statistics.fmean(values)
    reach = SURE * statistics.stdev(values) / len(values) ** 0.5 if len(values) > 1 else 0.0
    return f"{middle:{sign}.3f} ± {reach:.3f}"


def rows_of(played: dict[str, list[Played]]) -> list[str]:
    """Return a row of the table for each agent."""
    first = next(iter(played.values()))
    rows = []
    for name, matches in played.items():
        spl = [match.spl for match in matches]
        better = [match.spl - other.spl for match, other in zip(matches, first, strict=True)]
        gain = "" if matches is first else mean(better, "+")
        time_taken = 1000.0 * statistics.fmean(match.act_time for match in matches)
        success = rate([match.success for match in matches])
        rows.append(f"| `{name}` | {success} | {mean(spl)} | {gain} | {time_taken:.1f} ms |")
    return rows


def main(
    where: Annotated[Where, typer.Option(help="The maps and matches.")] = "hard",
    matches: Annotated[int, typer.Option(help="Number of matches.", min=1)] = 100,
    agents: Annotated[str, typer.Option(help="The agents, separated by commas.")] = (
        "homing,navigator,mapper,oracle"
    ),
) -> None:
    """Print the table."""
    players = {name: player(name) for name in agents.split(",")}
    played: dict[str, list[Played]] = {name: [] for name in players}
    for spec, game_map in track(matches_on(where, matches), where, matches):
        for name, agent in players.items():
            # The oracle stops at each corner, so its steps are single frames.
            own = spec.model_copy(update={"frames_per_action": 1}) if name == "oracle" else spec
            played[name].append(play(agent, own, game_map))
    sys.stdout.write(f"{where}, {matches} matches\n\n")
    sys.stdout.write(
        f"| agent | success | SPL | SPL more than `{next(iter(players))}` | processor time a step |\n"
    )
    sys.stdout.write("|---|---|---|---|---|\n" + "\n".join(rows_of(played)) + "\n")


if __name__ == "__main__":
    typer.run(main)
