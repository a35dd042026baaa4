"""The match info and the observations that a match sends to its seats."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from wildscav.agent import MatchInfo, SupplyWave
from wildscav_server.time_limits import Clock

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match, StartInfo
    from wildscav_engine.specs.match_spec import MatchSpec


class SeatObservations:
    """The observations of some seats of a match, encoded for all seats at once."""

    def __init__(self, match: "Match", seats: Sequence[int]) -> None:
        from wildscav_server.hosting.observation_encoding import BUFFER_SIZE, put_observations

        self._match, self._put = match, put_observations
        self._numbers = np.array(seats, np.int64)
        self._row = {seat: row for row, seat in enumerate(seats)}
        self._out = np.zeros((len(seats), BUFFER_SIZE), np.uint8)
        self._lengths = np.zeros(len(seats), np.int64)

    def encode(self, time_banks: Iterable[float]) -> None:
        """Encode the seats' observations of the current state, with what is left of their time banks, s.

        Raises:
            ValueError: A number in the state is out of range.
        """
        left = np.array([*time_banks], np.float64)
        self._put(*self._match.tables, self._numbers, left, self._out, self._lengths)

    def of(self, seat: int) -> bytes:
        """Return a seat's encoded observation: the bytes of an ``Observation`` without tensors."""
        row = self._row[seat]
        return self._out[row, : self._lengths[row]].tobytes()


def match_info(match: "Match", seat: int, clock: Clock) -> MatchInfo:
    """Return the match info of a seat. It does not reveal the map's id and seed."""
    return info_from(match.spec, match.start_info(seat), seat, clock)


def info_from(spec: "MatchSpec", start: "StartInfo", seat: int, clock: Clock) -> MatchInfo:
    """Return the match info of a seat from the spec of its match and what it knows before the first step."""
    from wildscav_engine.specs.rules import FRAMES_PER_SECOND, Senses
    from wildscav_engine.tracks import TRACKS

    equipment = spec.equipment_of(seat)
    return MatchInfo(
        track=spec.track,
        seat=seat,
        seats=len(spec.seats),
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
        respawns=TRACKS[spec.track].respawns,
        supply_goal=spec.supply_goal or 0,
        senses=Senses(spec.rules.senses).name.lower(),
        turn_speed=spec.rules.turn_speed,
        spread=spec.rules.spread,
        recoil=spec.rules.recoil,
        walking_sway=spec.rules.walking_sway,
        turning_sway=spec.rules.turning_sway,
        bounty=spec.rules.bounty,
        clock=spec.clock,
        token_time=spec.thinking.token_time if spec.clock == "tokens" else 0.0,
        processor_time=spec.thinking.processor_time if spec.clock == "tokens" else 0.0,
    )
