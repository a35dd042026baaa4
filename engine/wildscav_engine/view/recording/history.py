"""The history of a match, step by step: a record re-simulated into arrays."""

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.sensors import ColorCamera, DepthCamera
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.state import NOBODY, NOT_ELIMINATED, Agents
from wildscav_engine.simulation.systems.zone import phase_at, zone_at
from wildscav_engine.view.recording import camera_poses

DEPTH_CAMERA = DepthCamera(width=64, height=36, far=200.0)
COLOR_CAMERA = ColorCamera(width=160, height=90, shadows=False)  # shadows would double the rendering time
# In longer matches only every second, third, … step gets one. A camera image takes tens of times as long.
MAX_DEPTH_MAPS, MAX_PICTURES = 3000, 100
DEPTH_BATCH = 256  # depth maps that are rendered together, to bound memory


class Boxes(NamedTuple):
    """The supply boxes that are present from one row on, until the next such set."""

    row: int
    position: NDArray[np.float64]  # (N, 3) m
    quantity: NDArray[np.int32]  # (N,)
    serial: NDArray[np.int32]  # (N,)


class ImageSequence(NamedTuple):
    """The images of one camera over time."""

    rows: NDArray[np.int64]  # (D,) the row of each image
    images: NDArray[Any]  # (D, *shape)


class Death(NamedTuple):
    """An agent dies."""

    row: int
    seat: int
    by: int  # the seat whose shot it was, or NOBODY
    is_out: bool


class History(NamedTuple):
    """A whole match: row 0 is the start, row n the state after step n."""

    frame: NDArray[np.int64]  # (T + 1,) frames played
    agents: Agents  # every array has rows (T + 1) in place of matches, then seats
    reached_by: NDArray[np.int32]  # (T + 1,) the seat that reached the target, or NOBODY
    boxes: tuple[Boxes, ...]  # one set for each change, the first for row 0
    first_dropped: int  # serial number of the first box that an agent dropped
    target: NDArray[np.float64] | None  # (3,) m, None in tracks without a target
    zone: NDArray[np.float64] | None  # (T + 1, 6) m, x, z and radius of the safe zone and of its next circle
    depth: ImageSequence | None
    color: ImageSequence | None

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

    def hits(self) -> Iterator[tuple[int, int, int]]:
        """Yield (row, seat, victim) of every shot that hit somebody, in chronological order."""
        agents = self.agents
        for row, seat in seats_where(agents.fired & (agents.hit_seat != NOBODY)):
            yield row, seat, int(agents.hit_seat[row, seat])

    def deaths(self) -> Iterator[Death]:
        """Yield all deaths in chronological order."""
        agents = self.agents
        for row, seat in seats_where(np.diff(agents.deaths, axis=0, prepend=agents.deaths[:1]) > 0):
            by, is_out = int(agents.hit_by_seat[row, seat]), agents.eliminated[row, seat] != NOT_ELIMINATED
            yield Death(row, seat, by, bool(is_out))

    def arrival(self) -> tuple[int, int] | None:
        """Return the row in which the target is reached, and by which seat; None if it is not."""
        reached = np.flatnonzero(self.reached_by != NOBODY)
        return (int(reached[0]), int(self.reached_by[reached[0]])) if len(reached) else None

    def team_of(self, seat: int) -> int:
        """Return the team of a seat."""
        return int(self.teams[seat])


def collect_history(matches: Iterable[Match], steps: int, images_of: int | None) -> tuple[Match, History]:
    """Play a re-simulation to its end and collect its history.

    Args:
        matches: The match at its start and after each step, always the same object.
        steps: The maximum number of steps after the start.
        images_of: The seat whose depth maps and camera images are rendered, or None.

    Returns:
        The match at its end, and its history.
    """
    interval = -(-(steps + 1) // (MAX_PICTURES - 1))
    with_image = {*range(0, steps + 1, interval), steps}  # with the last step, where a replay stops
    pictures: dict[int, NDArray[np.uint8]] = {}
    boxes: list[Boxes] = []
    frames, reached = np.zeros(steps + 1, np.int64), np.zeros(steps + 1, np.int32)
    rows = 0
    for row, match in enumerate(matches):
        state = match.state
        if row == 0:
            agents = Agents._make(np.zeros((steps + 1, *each.shape[1:]), each.dtype) for each in state.agents)
            first_dropped = int(state.matches.next_serial[0])
        for name in Agents._fields:
            getattr(agents, name)[row] = getattr(state.agents, name)[0]
        frames[row], reached[row] = match.frame, state.matches.reached_by[0]
        _add_boxes(row, match, boxes)
        if images_of is not None and row in with_image:
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
        None if images_of is None else ImageSequence(np.array([*pictures]), np.array([*pictures.values()])),
    )


def _zone(match: Match, frames: NDArray[np.int64]) -> NDArray[np.float64] | None:
    """Return the safe zone in some frames with its next circle, or None if the match has no zone."""
    matches = match.state.matches
    if matches.phases[0] == 0:
        return None
    now = [zone_at(matches, 0, frame)[:3] for frame in frames.tolist()]
    phases = [phase_at(matches, 0, frame) for frame in frames.tolist()]
    return np.hstack([now, matches.zone[0, phases, 5:8]])


def _depth_maps(game_map: GameMap, agents: Agents, seat: int) -> ImageSequence:
    """Return the depth maps of an agent, which depend only on the map, as they omit dynamic objects."""
    length = len(agents.yaw)
    rows = np.arange(0, length, -(-length // MAX_DEPTH_MAPS))
    eyes = camera_poses.at_the_eyes(agents, seat)
    maps = [
        DEPTH_CAMERA.render(game_map, eyes.position[some], eyes.yaw[some], eyes.pitch[some])
        for some in (rows[start : start + DEPTH_BATCH] for start in range(0, len(rows), DEPTH_BATCH))
    ]
    return ImageSequence(rows, np.concatenate(maps))


def _add_boxes(row: int, match: Match, boxes: list[Boxes]) -> None:
    """Append the present boxes, if they differ from the previous ones."""
    supplies = match.state.supplies
    there = (supplies.quantity[0] > 0) & (supplies.appears[0] <= match.frame)
    serial, quantity = supplies.serial[0][there], supplies.quantity[0][there]
    if boxes and np.array_equal(boxes[-1].serial, serial) and np.array_equal(boxes[-1].quantity, quantity):
        return
    boxes.append(Boxes(row, supplies.position[0][there], quantity, serial))


def changes(*values: NDArray[np.generic]) -> NDArray[np.int64]:
    """Return the rows in which any of the values (T + 1, …) differs from the row before, and row 0."""
    changed = np.zeros(len(values[0]), np.bool_)
    changed[0] = True
    for value in values:
        flat = value.reshape(len(value), -1)
        changed[1:] |= np.any(flat[1:] != flat[:-1], axis=1)
    return np.nonzero(changed)[0]


def seats_where(condition: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """Yield (row, seat) of every true entry, in chronological order."""
    for row, seat in zip(*np.nonzero(condition), strict=True):
        yield int(row), int(seat)
