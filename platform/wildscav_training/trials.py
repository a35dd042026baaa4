"""Matches that agents play in this process to be measured, and what they reach, with 95 % intervals."""

import statistics
import time
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from wildscav_engine.envs import SeatController
from wildscav_engine.envs.settings.config import read_config
from wildscav_engine.envs.settings.ladders import GROUND, LADDERS
from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
from wildscav_engine.maps.cache import map_of
from wildscav_engine.maps.levels import Level
from wildscav_engine.maps.pools import random_maps
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.specs.actions import no_actions
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.tracks import TRACKS
from wildscav_training.opponents import Oracle

SURE = 1.96  # standard errors in a 95 % interval
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
    """Yield one match on each test map of a level, of the track's ladder or else as environments have it."""
    ladder = {"preset": f"ladder-{track}"} if f"ladder-{track}" in LADDERS else {}
    config = read_config(track, {"level": level, **ladder})
    pool = random_maps(GROUND if ladder else level, split="test", size=count)
    for number in range(count):
        yield config.match_spec().model_copy(update={"map": pool[number].spec, "seed": number})


def play(agent: SeatController, spec: MatchSpec) -> Trial:
    """Let an agent play in the first seat of a match, until the match is over or the agent out of it.

    The oracle stops at every corner of its path, so its steps are single frames.
    """
    if isinstance(agent, Oracle):
        spec = spec.model_copy(update={"frames_per_action": 1})
    batch, times = play_out(agent, spec, 0)
    track, view = TRACKS[spec.track], MatchInBatch(batch, 0)
    return Trial({**track.measure(view, 0), **track.measure_slow(view, 0)}, statistics.fmean(times))


def play_out(agent: SeatController | None, spec: MatchSpec, seat: int) -> tuple[Batch, list[float]]:
    """Play a match until it is over or a seat out of it.

    Args:
        agent: Who plays in the seat; None: the robot that the spec names.
        spec: The match.
        seat: The seat.

    Returns:
        The match as it ended, and the processor time that the agent took for each step, s.
    """
    batch, times = Batch([spec], [map_of(spec.map)]), []
    match, seats = np.zeros(1, np.int64), np.array([seat])
    if agent is not None:
        agent.begin(batch, match, seats)
    actions = no_actions(len(spec.seats))[None]
    while not batch.state.matches.over[0] and batch.state.agents.placement[0, seat] == 0:
        began = time.process_time()
        if agent is not None:
            actions[0, seat] = agent.act(batch, match, seats)[0]
        times.append(time.process_time() - began)
        batch.step(actions)
    return batch, times


def estimate(name: str, trials: Sequence[Trial]) -> Estimate:
    """Return the mean of a metric; its interval is Wilson's for a rate, otherwise the normal one."""
    values = [trial.metrics[name] for trial in trials]
    middle = statistics.fmean(values)
    if name == SUCCESS:
        return Estimate(middle, *wilson(middle, len(values)))
    reach = half_width(values)
    return Estimate(middle, middle - reach, middle + reach)


def half_width(values: Sequence[float]) -> float:
    """Return how far the 95 % interval of a mean reaches to either side."""
    return SURE * statistics.stdev(values) / len(values) ** 0.5 if len(values) > 1 else 0.0


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


def mean(values: Sequence[float], sign: str = "") -> str:
    """Return a mean with its 95 % interval."""
    return f"{statistics.fmean(values):{sign}.3f} ± {half_width(values):.3f}"
