"""A single match, as the server, re-simulation and tests play it."""

import copy
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wildscav_engine.compilation.tables.array_tables import Addresses
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.simulation.batch import Batch, check_actions
from wildscav_engine.simulation.setup.match_setup import MatchSetupError, WaveInfo, seed_of_seat
from wildscav_engine.simulation.snapshot import History, StateError, decode
from wildscav_engine.simulation.state import Ending, State
from wildscav_engine.simulation.systems.visibility import Seen
from wildscav_engine.simulation.track import Track, measured
from wildscav_engine.specs.actions import FIELDS, no_actions
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.specs.result import MatchResult, SeatResult
from wildscav_engine.specs.thinking import Thinking

__all__ = ["Match", "MatchSetupError", "StartInfo", "StateError", "WaveInfo"]


class StartInfo(NamedTuple):
    """What a seat knows before the first step."""

    position: tuple[float, float, float]  # m
    target: tuple[float, float, float] | None  # m
    team: int
    seed: int  # private, 63 bits
    waves: tuple[WaveInfo, ...]  # of supplies, announced in advance


class Match:
    """One match, from its first state to its result."""

    def __init__(self, spec: MatchSpec, game_map: GameMap | None = None) -> None:
        """Set up a match.

        Raises:
            MatchSetupError: The match cannot be set up; the message says why.
        """
        self._batch = Batch([spec], None if game_map is None else [game_map])
        self.spec = spec
        self.game_map = self._batch.maps[0]
        self.actions_played: list[NDArray[np.float32]] = []
        self.digests: list[int] = []
        # What seats are told as their private seed, in place of the one that follows from the spec.
        self.seeds: Mapping[int, int] = {}
        self.thinking: Thinking | None = None  # how much its seats thought, if its host measured it

    @property
    def track(self) -> Track:
        """The track of the match."""
        return self._batch.track

    @property
    def state(self) -> State:
        """The state, with a leading axis of length one."""
        return self._batch.state

    @property
    def seen(self) -> Seen:
        """What each agent sees now, with a leading axis of length one."""
        return self._batch.seen

    @property
    def tables(self) -> tuple[Addresses, Addresses, Addresses, Addresses]:
        """The address tables of agents, boxes, match and ``seen``; ``set_state`` invalidates them."""
        return self._batch.tables

    @property
    def seats(self) -> int:
        """The number of seats."""
        return len(self.spec.seats)

    @property
    def robots(self) -> dict[int, str]:
        """The names of the robots by the seats that they fill."""
        return {seat: name for seat, name in enumerate(self.spec.seats) if name != SUBMISSION}

    @property
    def over(self) -> bool:
        """Whether the match has ended."""
        return bool(self.state.matches.over[0])

    @property
    def frame(self) -> int:
        """The number of frames played."""
        return int(self.state.matches.frame[0])

    @property
    def step_number(self) -> int:
        """The number of steps played."""
        return int(self.state.matches.step[0])

    @property
    def digest(self) -> int:
        """The 64-bit digest of all states and actions so far."""
        return int(self.state.matches.digest[0])

    def start_info(self, seat: int) -> StartInfo:
        """Return what a seat knows before the first step; ValueError if there is no such seat."""
        if not 0 <= seat < self.seats:
            raise ValueError(f"there is no seat {seat}; the seats are 0 to {self.seats - 1}")
        told = start_info(self._batch, 0, seat)
        return told._replace(seed=self.seeds.get(seat, told.seed))

    def step(self, actions: ArrayLike | None = None) -> None:
        """Play one step with the actions of all seats, as ``Batch.step`` does; nothing if it is over."""
        if self.over:
            return
        rows = no_actions(self.seats) if actions is None else check_actions(actions, (self.seats,))
        self.actions_played.append(self._batch.step(rows[np.newaxis])[0])
        self.digests.append(self.digest)

    def get_state(self) -> bytes:
        """Return the match as bytes: its state, and the actions and digests so far."""
        actions = np.array(self.actions_played, np.float32).reshape(-1, self.seats, FIELDS)
        return self._batch.get_state(0, History(actions, np.array(self.digests, np.uint64)))

    def set_state(self, data: bytes) -> None:
        """Continue from a state that ``get_state`` returned; the errors are those of ``Batch.set_state``."""
        if decode(data).history is None:
            raise StateError("the state is of a row of a batch, which does not keep what was played")
        history = self._batch.set_state(0, data)
        self.spec, self.game_map = self._batch.specs[0], self._batch.maps[0]
        self.actions_played = list(history.actions) if history else []
        self.digests = history.digests.tolist() if history else []

    def fork(self) -> "Match":
        """Return a match in the same state that goes its own way: with the same actions, the same way."""
        other = copy.copy(self)
        other._take_copies()  # noqa: SLF001 - it is one of these, too
        return other

    def _take_copies(self) -> None:
        """Replace all mutable data that is shared with another match by copies."""
        self._batch = self._batch.fork()
        self.actions_played, self.digests = list(self.actions_played), list(self.digests)

    def play_out(self) -> None:
        """Play the rest of the match without actions of submissions."""
        while not self.over:
            self.step()

    def result(self) -> MatchResult:
        """Return the result of the match so far."""
        return MatchResult(
            track=self.track.name,
            frames=self.frame,
            steps=self.step_number,
            ending=Ending(self.state.matches.ending[0]).name.lower(),
            seats=tuple(self._seat_result(seat) for seat in range(self.seats)),
        )

    def _seat_result(self, seat: int) -> SeatResult:
        agents = self.state.agents
        return SeatResult(
            seat=seat,
            filled_by=self.spec.seats[seat],
            team=int(agents.team[0, seat]),
            supplies=int(agents.supplies[0, seat]),
            kills=int(agents.kills[0, seat]),
            deaths=int(agents.deaths[0, seat]),
            shots=int(agents.shots[0, seat]),
            hits=int(agents.hits[0, seat]),
            walked=float(agents.walked[0, seat]),
            metrics=measured(self, seat),
        )


def start_info(batch: Batch, row: int, seat: int) -> StartInfo:
    """Return what a seat of a match in a batch knows before the first step."""
    spec, setup = batch.specs[row], batch.setups[row]
    target = None if setup.target is None or batch.track.hides_target else _triple(setup.target)
    seed, team = seed_of_seat(spec, seat), spec.team_of_seats[seat]
    return StartInfo(_triple(setup.starts[seat]), target, team, seed, setup.waves)


def _triple(position: Sequence[float] | NDArray[np.float64]) -> tuple[float, float, float]:
    return float(position[0]), float(position[1]), float(position[2])
