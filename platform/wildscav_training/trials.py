"""Matches that agents play in this process to be measured, and what they reach, with 95 % intervals."""

import math
import statistics
import time
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from wildscav_engine.envs import SeatController
from wildscav_engine.envs.settings.config import read_config
from wildscav_engine.envs.settings.presets import GROUND, LADDERS
from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
from wildscav_engine.maps.cache import map_of
from wildscav_engine.maps.levels import Level
from wildscav_engine.maps.pools import random_maps
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.specs.actions import no_actions
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_training.opponents import Oracle

SURE = 1.96  # standard errors in a 95 % interval, where they are known
SUCCESS = "success"  # the metric that is a rate


class Trial(NamedTuple):
    """One match of one agent."""

    metrics: Mapping[str, float]  # all those of the track
    act_time: float  # s of processor time a step, with its sensors


class Estimate(NamedTuple):
    """A mean with its 95 % interval."""

    mean: float
    low: float
    high: float


def matches_on(track: str, level: Level, count: int) -> Iterator[MatchSpec]:
    """Yield one match on each test map of a level, of the newest ladder or else as environments have it."""
    newest = f"ladder-{track}-v2"
    ladder = {"preset": newest} if newest in LADDERS else {}
    config = read_config(track, {"level": level, **ladder})
    pool = random_maps(GROUND if ladder else level, split="test", size=count)
    for number in range(count):
        yield config.match_spec().model_copy(update={"map": pool[number].spec, "seed": number})


def play(
    agent: SeatController,
    spec: MatchSpec,
    seats: Sequence[int] = (0,),
    others: Sequence[tuple[SeatController, int]] = (),
) -> Trial:
    """Let an agent play in some seats of a match, until the match is over or the agent out of it.

    The oracle stops at every corner of its path, so its steps are single frames.

    Args:
        seats: The agent's seats; its metrics are their means.
        others: Who plays in the other seats for submissions.
    """
    if isinstance(agent, Oracle):
        spec = spec.model_copy(update={"frames_per_action": 1})
    batch, times = play_out([(agent, seats), *((other, (seat,)) for other, seat in others)], spec, seats)
    return Trial(_mean_metrics(batch, seats), statistics.fmean(times) / len(seats))


def _mean_metrics(batch: Batch, seats: Sequence[int]) -> dict[str, float]:
    """Return the means over some seats of all metrics of a track."""
    track, view = batch.track, MatchInBatch(batch, 0)
    measured = [{**track.measure(view, seat), **track.measure_slow(view, seat)} for seat in seats]
    return {name: statistics.fmean(each[name] for each in measured) for name in measured[0]}


def play_out(
    players: Sequence[tuple[SeatController, Sequence[int]]], spec: MatchSpec, own: Sequence[int]
) -> tuple[Batch, list[float]]:
    """Play a match until it is over or some seats are out of it.

    Args:
        players: Who plays, with their seats; robots play in those that nobody has.
        own: The seats that matter.

    Returns:
        The match as it ended, and the processor time that the first player took for each step, s.
    """
    batch, times = Batch([spec], [map_of(spec.map)]), [0.0]
    seated = [(player, np.array(seats), np.zeros(len(seats), np.int64)) for player, seats in players]
    for player, seats, matches in seated:
        player.begin(batch, matches, seats)
    actions = no_actions(len(spec.seats))[None]
    while not batch.state.matches.over[0] and (batch.state.agents.placement[0, own] == 0).any():
        for place, (player, seats, matches) in enumerate(seated):
            began = time.process_time()
            actions[0, seats] = player.act(batch, matches, seats)
            if place == 0:
                times.append(time.process_time() - began)
        batch.step(actions)
    return batch, times[1:] or times


def estimate(name: str, trials: Sequence[Trial]) -> Estimate:
    """Return the mean of a metric; its interval is Wilson's for a rate, otherwise Student's."""
    values = [trial.metrics[name] for trial in trials]
    middle = statistics.fmean(values)
    if name == SUCCESS:
        return Estimate(middle, *wilson(middle, len(values)))
    reach = half_width(values)
    return Estimate(middle, middle - reach, middle + reach)


def half_width(values: Sequence[float]) -> float:
    """Return how far the 95 % interval of a mean reaches to either side; 0 for a single value."""
    if len(values) < 2:
        return 0.0
    return student(len(values) - 1) * statistics.stdev(values) / math.sqrt(len(values))


@cache
def student(freedom: int) -> float:
    """Return how many standard errors a 95 % interval reaches to either side, by its degrees of freedom."""
    low, high = 0.0, math.pi / 2.0
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _share_within(middle, freedom) < 0.95 else (low, middle)
    return math.tan(low) * math.sqrt(freedom)


def _share_within(angle: float, freedom: int) -> float:
    """Return the probability that Student's t lies within ± tan(angle) · √freedom.

    Abramowitz & Stegun, "Handbook of Mathematical Functions", 1964, 26.7.3 and 26.7.4.
    """
    is_odd = freedom % 2
    term, total = math.cos(angle) ** is_odd, 0.0
    for power in range(is_odd, freedom - 1, 2):
        total += term
        term *= (power + 1) / (power + 2) * math.cos(angle) ** 2
    share = math.sin(angle) * total
    return (angle + share) * 2.0 / math.pi if is_odd else share


def wilson(share: float, count: int) -> tuple[float, float]:
    """Return the 95 % interval of a success rate (Wilson 1927)."""
    middle = (share + SURE * SURE / (2 * count)) / (1 + SURE * SURE / count)
    reach = SURE / (1 + SURE * SURE / count)
    reach *= (share * (1 - share) / count + SURE * SURE / (4 * count * count)) ** 0.5
    return max(0.0, middle - reach), min(1.0, middle + reach)


def rate(successes: Sequence[float]) -> str:
    """Return a success rate with its 95 % interval."""
    share = statistics.fmean(successes)
    low, high = wilson(share, len(successes))
    return f"{100.0 * share:.1f} % ({100.0 * low:.1f}–{100.0 * high:.1f})"


def mean(values: Sequence[float], sign: str = "", digits: int = 3) -> str:
    """Return a mean with its 95 % interval."""
    return f"{statistics.fmean(values):{sign}.{digits}f} ± {half_width(values):.{digits}f}"
