"""What happened in a match, step by step: a record re-simulated into arrays."""

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.sensors import ColorCamera, DepthCamera
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.state import Agents
from wildscav_engine.simulation.systems.zone import phase_at, zone_at
from wildscav_engine.view.recording import cameras

DEPTH_CAMERA = DepthCamera(width=64, height=36, far=200.0)
COLOR_CAMERA = ColorCamera(width=160, height=90, shadows=False)  # shadows would double the time
# Longer matches get every second, third, … step only. A picture takes tens of times as long as a depth map.
MOST_DEPTH_MAPS, MOST_PICTURES = 3000, 100
AT_ONCE = 256  # depth maps, to keep memory small


class Boxes(NamedTuple):
    """The supply boxes that are there from one row on, until the next such set."""

    row: int
    position: NDArray[np.float64]  # (N, 3) m
    quantity: NDArray[np.int32]  # (N,)
    serial: NDArray[np.int32]  # (N,)


class Film(NamedTuple):
    """What one agent saw through one camera."""

    rows: NDArray[np.int64]  # (D,) when
    images: NDArray[Any]  # (D, *shape) as the camera makes them


class History(NamedTuple):
    """A whole match: row 0 is the start, row n is after step n."""

    frame: NDArray[np.int64]  # (T + 1,) frames played
    agents: Agents  # every array has rows (T + 1) in place of matches, then seats
    reached_by: NDArray[np.int32]  # (T + 1,) the seat that reached the target, or NOBODY
    boxes: tuple[Boxes, ...]  # one for each change, the first for row 0
    first_dropped: int  # serial of the first box that was not there by plan
    target: NDArray[np.float64] | None  # (3,) m, what ends the match when reached
    zone: NDArray[np.float64] | None  # (T + 1, 6) m, x, z and radius of the safe zone and of its next circle
    depth: Film | None
    color: Film | None

    @property
    def rows(self) -> NDArray[np.int64]:
        """All rows, (T + 1,)."""
        return np.arange(len(self.frame))

    @property
    def teams(self) -> NDArray[np.int32]:
        """The team of each seat, (A,)."""
        return np.asarray(self.agents.team[0], np.int32)

    @property
    def has_teammates(self) -> bool:
        """Whether some team has more than one seat."""
        return len(np.unique(self.teams)) < len(self.teams)

    @property
    def supplies_of_team(self) -> NDArray[np.int64]:
        """What the team of each seat carries, (T + 1, A)."""
        together = self.teams[:, None] == self.teams
        return np.asarray(self.agents.supplies.astype(np.int64) @ together)

    @property
    def distance_to_target(self) -> NDArray[np.float64]:
        """How far each seat is from the target, (T + 1, A) m; infinite where there is none."""
        target = np.full(3, np.inf) if self.target is None else self.target
        return np.asarray(np.linalg.norm(self.agents.position - target, axis=-1))

    def team_of(self, seat: int) -> int:
        """Return the team of a seat."""
        return int(self.teams[seat])


def collect(matches: Iterable[Match], steps: int, images_of: int | None) -> tuple[Match, History]:
    """Play a re-simulation to its end.

    Args:
        matches: The match at its start and after each step, always the same object.
        steps: How many steps come after the start, at the most.
        images_of: The seat whose depth maps and pictures are kept, if any.

    Returns:
        The match at its end, and all that happened.
    """
    each = -(-(steps + 1) // (MOST_PICTURES - 1))
    filmed = {*range(0, steps + 1, each), steps}  # where a replay stops, all cameras show the same moment
    pictures: dict[int, NDArray[np.uint8]] = {}
    boxes: list[Boxes] = []
    frames, reached = np.zeros(steps + 1, np.int64), np.zeros(steps + 1, np.int32)
    rows = 0
    for row, match in enumerate(matches):
        state = match.state
        if row == 0:
            agents = Agents._make(_rows_of(field, steps + 1) for field in state.agents)
            first_dropped = int(state.matches.next_serial[0])
        for name in Agents._fields:
            getattr(agents, name)[row] = getattr(state.agents, name)[0]
        frames[row], reached[row] = match.frame, state.matches.reached_by[0]
        _note_boxes(row, match, boxes)
        if images_of is not None and row in filmed:
            pictures[row] = COLOR_CAMERA.read(match, [images_of])[0]
        rows = row + 1
    target = match.state.matches.target[0].copy() if match.state.matches.has_target[0] else None
    kept = Agents._make(field[:rows] for field in agents)
    return match, History(
        frames[:rows],
        kept,
        reached[:rows],
        tuple(boxes),
        first_dropped,
        target,
        _zone(match, frames[:rows]),
        None if images_of is None else _depth_maps(match.game_map, kept, images_of),
        None if images_of is None else Film(np.array([*pictures]), np.array([*pictures.values()])),
    )


def _zone(match: Match, frames: NDArray[np.int64]) -> NDArray[np.float64] | None:
    """Return the safe zone in some frames, and the circle that it draws in to then, if there is one."""
    matches = match.state.matches
    if matches.phases[0] == 0:
        return None
    now = [zone_at(matches, 0, frame)[:3] for frame in frames.tolist()]
    phases = [phase_at(matches, 0, frame) for frame in frames.tolist()]
    return np.hstack([now, matches.zone[0, phases, 5:8]])


def _depth_maps(game_map: GameMap, agents: Agents, seat: int) -> Film:
    """Return what the depth camera of an agent saw: it sees no moving things, so the map is all it needs."""
    length = len(agents.yaw)
    rows = np.arange(0, length, -(-length // MOST_DEPTH_MAPS))
    eyes = cameras.at_the_eyes(agents, seat)
    maps = [
        DEPTH_CAMERA.render(game_map, eyes.position[some], eyes.yaw[some], eyes.pitch[some])
        for some in (rows[start : start + AT_ONCE] for start in range(0, len(rows), AT_ONCE))
    ]
    return Film(rows, np.concatenate(maps))


def _rows_of(field: NDArray[Any], rows: int) -> NDArray[Any]:
    """Return room for what one match has in a field of the state, over time."""
    return np.zeros((rows, *field.shape[1:]), field.dtype)


def _note_boxes(row: int, match: Match, boxes: list[Boxes]) -> None:
    """Add the boxes that are there now, if they are not the same as before."""
    supplies = match.state.supplies
    there = (supplies.quantity[0] > 0) & (supplies.appears[0] <= match.frame)
    serial, quantity = supplies.serial[0][there], supplies.quantity[0][there]
    if boxes and np.array_equal(boxes[-1].serial, serial) and np.array_equal(boxes[-1].quantity, quantity):
        return
    boxes.append(Boxes(row, supplies.position[0][there], quantity, serial))


def changes(*values: NDArray[np.generic]) -> NDArray[np.int64]:
    """Return the rows where any of the values (T + 1, …) differs from the row before; row 0 is one."""
    changed = np.zeros(len(values[0]), np.bool_)
    changed[0] = True
    for value in values:
        flat = value.reshape(len(value), -1)
        changed[1:] |= np.any(flat[1:] != flat[:-1], axis=1)
    return np.nonzero(changed)[0]


def seats_where(condition: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """Yield (row, seat) of every true entry, in time order."""
    for row, seat in zip(*np.nonzero(condition), strict=True):
        yield int(row), int(seat)
