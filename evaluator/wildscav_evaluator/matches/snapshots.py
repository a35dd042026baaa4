"""Snapshots of a match that is being played: as much of its state as spectators see."""

from typing import NamedTuple

import numpy as np

from wildscav_engine.simulation.match import Match

CENTIMETRES = 100  # in a metre
# Values of ``Agents`` that a snapshot shows of each seat, beside its position.
SHOWN = ("yaw", "pitch", "health", "supplies", "kills", "deaths")


class SeatSnapshot(NamedTuple):
    """One seat at one moment, in whole numbers, so that a snapshot stays small."""

    x: int  # cm
    height: int  # cm, of the soles
    z: int  # cm
    yaw: int  # degrees
    pitch: int  # degrees, positive looks down
    health: int  # hp
    supplies: int  # carried
    kills: int
    deaths: int


class Snapshot(NamedTuple):
    """A match at one moment."""

    frame: int
    seats: tuple[SeatSnapshot, ...]
    target: tuple[int, int, int] | None  # cm; None if the match has none
    reached_by: int | None  # the seat that reached it


def snapshot_of(match: Match) -> Snapshot:
    """Return what spectators see of a match now."""
    agents, matches = match.state.agents, match.state.matches
    columns = [agents.position[0] * CENTIMETRES, *(getattr(agents, name)[0][:, None] for name in SHOWN)]
    rows = np.rint(np.hstack(columns)).astype(int).tolist()
    target, reached_by = None, int(matches.reached_by[0])
    if matches.has_target[0]:
        x, y, z = np.rint(matches.target[0] * CENTIMETRES).astype(int).tolist()
        target = (x, y, z)
    seats = tuple(SeatSnapshot(*row) for row in rows)
    return Snapshot(match.frame, seats, target, reached_by if reached_by >= 0 else None)
