"""Snapshots of a match that is being played: as much of its state as spectators see, and what happened.

All numbers are whole, so that a snapshot stays small: lengths in centimetres, angles in degrees.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.state import NOBODY, NOT_ELIMINATED
from wildscav_engine.specs.match_spec import MatchSpec

HEARTBEAT_INTERVAL = 0.5  # s between two heartbeats of a match, which carry its snapshots
CENTIMETRES = 100  # in a metre
SHOWN = ("yaw", "pitch", "health", "supplies")  # of ``Agents``, beside the position


class SeatSnapshot(NamedTuple):
    """One seat at one moment."""

    x: int
    height: int  # of the soles
    z: int
    yaw: int
    pitch: int  # positive looks down
    health: int  # hp
    supplies: int  # carried


class Happening(NamedTuple):
    """What a seat did, or what happened to it; ``Event`` of the stage's documents says what is meant."""

    frame: int
    kind: str
    seat: int
    other: int | None = None
    amount: int = 0


class Shot(NamedTuple):
    """A shot, and where it ended."""

    frame: int
    seat: int
    x: int
    height: int
    z: int


class BoxSnapshot(NamedTuple):
    """A box of supplies that has appeared."""

    serial: int
    frame: int
    x: int
    height: int
    z: int
    dropped: bool  # by an agent that died
    quantity: int


class Snapshot(NamedTuple):
    """A match at one moment, and what happened since the snapshot before."""

    frame: int
    first: bool  # whether it is the first of its match
    seats: tuple[SeatSnapshot, ...]
    target: tuple[int, int, int] | None  # None if the match has none
    happened: tuple[Happening, ...]
    shots: tuple[Shot, ...]
    appeared: tuple[BoxSnapshot, ...]
    taken: tuple[tuple[int, int], ...]  # serials of boxes that are gone, each with the frame


class Happenings:
    """What happens in a match, step by step from its start."""

    def __init__(self, match: Match) -> None:
        agents = match.state.agents
        self._match, self._is_first = match, True
        self._deaths, self._alive = agents.deaths[0].copy(), agents.health[0] > 0
        self._reached = False
        self._first_dropped = int(match.state.matches.next_serial[0])
        self._serials = np.zeros(0, np.int32)  # of the boxes that are present
        self._forget()
        self._note_boxes()

    def _forget(self) -> None:
        self._happened: list[Happening] = []
        self._shots: list[Shot] = []
        self._appeared: list[BoxSnapshot] = []
        self._taken: list[tuple[int, int]] = []

    def note(self) -> None:
        """Note what happened in a step that was played."""
        self._note_shots()
        self._note_lives()
        agents, frame = self._match.state.agents, self._match.frame
        for seat in np.flatnonzero(agents.gained[0] > 0).tolist():
            self._happened.append(Happening(frame, "pick_up", seat, amount=int(agents.gained[0, seat])))
        reached = int(self._match.state.matches.reached_by[0])
        if reached != NOBODY and not self._reached:
            self._reached = True
            self._happened.append(Happening(frame, "target", reached))
        self._note_boxes()

    def _note_shots(self) -> None:
        agents, frame = self._match.state.agents, self._match.frame
        for seat in np.flatnonzero(agents.fired[0]).tolist():
            self._shots.append(Shot(frame, seat, *_centimetres(agents.shot_end[0, seat])))
            victim = int(agents.hit_seat[0, seat])
            if victim != NOBODY:
                left = int(agents.health[0, victim])
                self._happened.append(Happening(frame, "hit", seat, victim, left))

    def _note_lives(self) -> None:
        agents, frame = self._match.state.agents, self._match.frame
        for seat in np.flatnonzero(agents.deaths[0] > self._deaths).tolist():
            by = int(agents.hit_by_seat[0, seat])
            kind = "death" if agents.eliminated[0, seat] == NOT_ELIMINATED else "out"
            self._happened.append(Happening(frame, kind, seat, None if by == NOBODY else by))
        alive = agents.health[0] > 0
        back = np.flatnonzero(alive & ~self._alive).tolist()
        self._happened += [Happening(frame, "respawn", seat) for seat in back]
        self._deaths[:], self._alive = agents.deaths[0], alive

    def _note_boxes(self) -> None:
        supplies, frame = self._match.state.supplies, self._match.frame
        slots = np.flatnonzero((supplies.quantity[0] > 0) & (supplies.appears[0] <= frame))
        serials = supplies.serial[0][slots]
        if np.array_equal(serials, self._serials):
            return
        before, now = set(self._serials.tolist()), set(serials.tolist())
        self._taken += [(serial, frame) for serial in sorted(before - now)]
        for slot, serial in zip(slots.tolist(), serials.tolist(), strict=True):
            if serial not in before:
                place = _centimetres(supplies.position[0, slot])
                rest = serial >= self._first_dropped, int(supplies.quantity[0, slot])
                self._appeared.append(BoxSnapshot(serial, frame, *place, *rest))
        self._serials = serials

    def take(self) -> Snapshot:
        """Return a snapshot of this moment; what happened until now is in no other one."""
        match, is_first = self._match, self._is_first
        agents, matches = match.state.agents, match.state.matches
        columns = [agents.position[0] * CENTIMETRES, *(getattr(agents, name)[0][:, None] for name in SHOWN)]
        rows = np.rint(np.hstack(columns)).astype(int).tolist()
        snapshot = Snapshot(
            match.frame,
            is_first,
            tuple(SeatSnapshot(*row) for row in rows),
            _centimetres(matches.target[0]) if matches.has_target[0] else None,
            tuple(self._happened),
            tuple(self._shots),
            tuple(self._appeared),
            tuple(self._taken),
        )
        self._is_first = False
        self._forget()
        return snapshot


class WatchedMatch(Match):
    """A match that notes what happens in it."""

    def __init__(self, spec: MatchSpec, game_map: GameMap | None = None) -> None:
        super().__init__(spec, game_map)
        self.happenings = Happenings(self)

    def step(self, actions: ArrayLike | None = None) -> None:
        """Play one step, and note what happened."""
        if not self.over:
            super().step(actions)
            self.happenings.note()


def _centimetres(place: ArrayLike) -> tuple[int, int, int]:
    """Return a (3,) m place in whole centimetres."""
    x, height, z = np.rint(np.asarray(place) * CENTIMETRES).astype(int).tolist()
    return x, height, z
