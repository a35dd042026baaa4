"""What a match tells its seats: at its start, and at every step."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from wildscav.agent import MatchInfo, SupplyWave
from wildscav.server.hosting.time_limits import Clock

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match


class SeatObservations:
    """What some seats of a match observe: encoded for all at once, handed out one by one.

    Args:
        match: At any moment.
        seats: Their numbers.
    """

    def __init__(self, match: "Match", seats: Sequence[int]) -> None:
        from wildscav.server.hosting.observation_encoding import ROOM, put_observations

        self._match, self._put = match, put_observations
        self._numbers = np.array(seats, np.int64)
        self._place = {seat: place for place, seat in enumerate(seats)}
        self._out = np.zeros((len(seats), ROOM), np.uint8)
        self._lengths = np.zeros(len(seats), np.int64)

    def encode(self, time_banks: Iterable[float]) -> None:
        """Encode what the seats observe in the match's present state.

        Args:
            time_banks: What each of the seats has left, s.

        Raises:
            ValueError: A number in the state is out of its range.
        """
        left = np.array([*time_banks], np.float64)
        self._put(*self._match.tables, self._numbers, left, self._out, self._lengths)

    def of(self, seat: int) -> bytes:
        """Return what a seat observed then, as the bytes of an ``Observation`` without tensors."""
        place = self._place[seat]
        return self._out[place, : self._lengths[place]].tobytes()


def match_info(match: "Match", seat: int, clock: Clock) -> MatchInfo:
    """Return what a seat is told before the first step. The map's id and seed are not in it."""
    from wildscav_engine.specs.rules import FRAMES_PER_SECOND

    spec, start = match.spec, match.start_info(seat)
    equipment = spec.equipment_of(seat)
    return MatchInfo(
        track=spec.track,
        seat=seat,
        seats=match.seats,
        team=start.team,
        time_limit=spec.time_limit,
        frames_per_action=spec.frames_per_action,
        frames_per_second=FRAMES_PER_SECOND,
        map_size=spec.map.config.size,
        start=start.position,
        target=start.target,
        supply_waves=tuple(SupplyWave(wave.time, wave.center, wave.radius) for wave in start.waves),
        seed=start.seed,
        step_budget=clock.step_budget,
        time_bank=clock.time_bank,
        target_distance=spec.rules.target_distance,
        pick_up_distance=spec.rules.pick_up_distance,
        supply_sight=spec.rules.supply_sight,
        clip_size=equipment.clip_size,
        start_health=equipment.health,
        respawns=match.track.respawns,
        supply_goal=spec.supply_goal or 0,
    )
