"""One match: what the server, re-simulation and tests play."""

import copy
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wildscav_engine.compilation.array_tables import Addresses
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

__all__ = ["Match", "MatchSetupError", "StartInfo", "StateError", "WaveInfo"]


class StartInfo(NamedTuple):
    """What a seat is told before the first step."""

    position: tuple[float, float, float]  # m
    target: tuple[float, float, float] | None  # m
    team: int
    seed: int  # private, 63 bits
    waves: tuple[WaveInfo, ...]  # of supplies, known in advance


class Match:
    """One match, from its first state to its result."""

    def __init__(self, spec: MatchSpec, game_map: GameMap | None = None) -> None:
        """Set a match up.

        Args:
            spec: The match.
            game_map: Its map, where it is at hand; else it is made.

        Raises:
            MatchSetupError: The match cannot be set up; the message says why.
        """
        self._batch = Batch([spec], None if game_map is None else [game_map])
        self.spec = spec
        self.game_map = self._batch.maps[0]
        self.actions_played: list[NDArray[np.float32]] = []
        self.digests: list[int] = []

    @property
    def track(self) -> Track:
        """The kind of match."""
        return self._batch.track

    @property
    def state(self) -> State:
        """The state, with a leading axis of length one."""
        return self._batch.state

    @property
    def seen(self) -> Seen:
        """What every agent sees now, with a leading axis of length one."""
        return self._batch.seen

    @property
    def tables(self) -> tuple[Addresses, Addresses, Addresses, Addresses]:
        """Where agents, boxes, the match and what is seen now lie, for kernels, until ``set_state``."""
        return self._batch.tables

    @property
    def seats(self) -> int:
        """How many seats there are."""
        return len(self.spec.seats)

    @property
    def robots(self) -> dict[int, str]:
        """The seats that robots fill, and which."""
        return {seat: name for seat, name in enumerate(self.spec.seats) if name != SUBMISSION}

    @property
    def over(self) -> bool:
        """Whether the match has ended."""
        return bool(self.state.matches.over[0])

    @property
    def frame(self) -> int:
        """Frames played so far."""
        return int(self.state.matches.frame[0])

    @property
    def step_number(self) -> int:
        """Steps played so far."""
        return int(self.state.matches.step[0])

    @property
    def digest(self) -> int:
        """The 64-bit digest of all states and actions so far."""
        return int(self.state.matches.digest[0])

    def start_info(self, seat: int) -> StartInfo:
        """Return what a seat is told before the first step.

        Raises:
            ValueError: The match has no such seat.
        """
        if not 0 <= seat < self.seats:
            raise ValueError(f"there is no seat {seat}; the seats are 0 to {self.seats - 1}")
        setup = self._batch.setups[0]
        target = None if setup.target is None or self.track.hides_target else _triple(setup.target)
        seed = seed_of_seat(self.spec, seat)
        team = self.spec.team_of_seats[seat]
        return StartInfo(_triple(setup.starts[seat]), target, team, seed, setup.waves)

    def step(self, actions: ArrayLike | None = None) -> None:
        """Play one step; nothing happens once the match is over.

        Args:
            actions: (A, FIELDS), as ``Batch.step`` takes them; None for no action of anyone.

        Raises:
            ValueError: The actions have another shape or are no real numbers.
        """
        if self.over:
            return
        rows = no_actions(self.seats) if actions is None else check_actions(actions, (self.seats,))
        self.actions_played.append(self._batch.step(rows[np.newaxis])[0])
        self.digests.append(self.digest)

    def get_state(self) -> bytes:
        """Return the match as bytes: all that it takes to go on, and what was played so far."""
        actions = np.array(self.actions_played, np.float32).reshape(-1, self.seats, FIELDS)
        return self._batch.get_state(0, History(actions, np.array(self.digests, np.uint64)))

    def set_state(self, data: bytes) -> None:
        """Go on from a state that ``get_state`` gave, of this match or of another one of its track and rules.

        Raises:
            StateError: The bytes are no state of a match, damaged, or of another version of the rules or of
                the map.
            MatchSetupError: The match has another track, other rules or more seats than this one.
        """
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
        """Let go of everything that is shared and changes."""
        self._batch = self._batch.fork()
        self.actions_played, self.digests = list(self.actions_played), list(self.digests)

    def play_out(self) -> None:
        """Play the rest of the match with no action of the submissions."""
        while not self.over:
            self.step()

    def result(self) -> MatchResult:
        """Return the result, from the state as it stands."""
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


def _triple(place: Sequence[float] | NDArray[np.float64]) -> tuple[float, float, float]:
    return float(place[0]), float(place[1]), float(place[2])
