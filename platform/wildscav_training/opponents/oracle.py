"""Agents to measure others by: one takes the shortest path to the target, one walks straight to it."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.envs import SeatController
from wildscav_engine.maps.walk import NavGraph, Path, find_path, node_near
from wildscav_engine.maps.walk.explore import ARRIVAL
from wildscav_engine.maps.walk.lattice import NO_EDGE
from wildscav_engine.maps.walk.leaps import LEAP_SPEED
from wildscav_engine.maps.walk.paths import Place
from wildscav_engine.specs.actions import FIELDS, MAX_WALK_SPEED, Field
from wildscav_engine.specs.rules import FRAME
from wildscav_training.opponents.seat_messages import Indices

if TYPE_CHECKING:
    from wildscav_engine.simulation.batch import Batch

ARRIVED = 0.01  # m; a leg of a path ends here
TARGET_TRACKS = ("navigation", "capture")
STUCK = 10  # steps on the spot, after which it tries something else


def check_has_target(name: str, track: str) -> None:
    """Raise a ValueError for a track without a target, for an agent that needs one."""
    if track not in TARGET_TRACKS:
        raise ValueError(f"{name} plays {' and '.join(TARGET_TRACKS)}, not {track}")


class Oracle(SeatController):
    """Follows the shortest path over the map's own graph; it knows the target of a capture, too.

    It stops at every corner of its path, so it is fastest in matches of one frame a step.
    """

    name = "oracle"

    def __init__(self) -> None:
        """Begin with no matches."""
        self._walkers: dict[tuple[int, int], PathWalker] = {}  # by match and seat

    def check(self, track: str) -> None:
        """Raise a ValueError for a track without a target. See ``SeatController.check``."""
        check_has_target("the oracle", track)

    def begin(self, batch: "Batch", matches: Indices, seats: Indices) -> None:
        """Search for each seat's path; a ValueError without a target. See ``SeatController.begin``."""
        self.check(batch.track.name)
        for match, seat in zip(matches.tolist(), seats.tolist(), strict=True):
            start, target = batch.state.agents.position[match, seat], batch.state.matches.target[match]
            self._walkers[match, seat] = PathWalker(batch.maps[match].graph, start, target)

    def act(self, batch: "Batch", matches: Indices, seats: Indices) -> NDArray[np.float32]:
        """Return (N, FIELDS) rows of actions. See ``SeatController.act``."""
        rows = np.zeros((len(seats), FIELDS), np.float32)
        agents, seconds = batch.state.agents, batch.frames_per_action * FRAME
        for row, match, seat in zip(rows, matches.tolist(), seats.tolist(), strict=True):
            at = match, seat
            self._walkers[at].put_action(row, agents.position[at], bool(agents.on_ground[at]), seconds)
        return rows


class Straight(SeatController):
    """Walks straight to the target; it knows the target of a capture, too."""

    name = "straight"

    def check(self, track: str) -> None:
        """Check that a track has a target. See ``SeatController.check``."""
        check_has_target(self.name, track)

    def begin(self, batch: "Batch", matches: Indices, seats: Indices) -> None:
        """Do nothing: it has no memory."""

    def act(self, batch: "Batch", matches: Indices, seats: Indices) -> NDArray[np.float32]:
        """Return (N, FIELDS) rows of actions. See ``SeatController.act``."""
        rows = np.zeros((len(seats), FIELDS), np.float32)
        offsets = batch.state.matches.target[matches] - batch.state.agents.position[matches, seats]
        rows[:, Field.WALK_DIRECTION] = np.degrees(np.arctan2(offsets[:, 0], offsets[:, 2])) % 360.0
        rows[:, Field.WALK_SPEED] = MAX_WALK_SPEED
        return rows


class PathWalker:
    """One body on its path.

    A body reaches a corner only to a centimetre or two. Where that holds it up, it takes the next corner,
    and if it cannot get there either, it takes a path that keeps more distance from walls. Where that holds
    it up, too, there is a gap in the floor that the graph does not know: it takes a path without that edge.
    """

    def __init__(self, graph: NavGraph, start: NDArray[np.float64], target: NDArray[np.float64]) -> None:
        """Search for the path from a start to a target, (3,) m, soles."""
        self.graph, self.target = graph, target.copy()
        self.path = find_path(graph, start, target)  # None if there is none
        self._follow(self.path)

    def _follow(self, path: Path | None) -> None:
        self.starts = (path.start, *(leg.end for leg in path.legs)) if path else ()
        self.legs = path.legs if path else ()
        self.leg = self.still = 0
        self.jumps = bool(self.legs and self.legs[0].jump)
        self.before = np.full(3, np.inf)

    def put_action(
        self, row: NDArray[np.float32], position: NDArray[np.float64], on_ground: bool, seconds: float
    ) -> None:
        """Write the next action.

        Args:
            row: (FIELDS,) zeros; receives the action. It stays as it is if there is no way left to go.
            position: (3,) m, where the body is.
        """
        self._get_unstuck(position)
        while self.leg < len(self.legs):
            leg = self.legs[self.leg]
            east, north = leg.end[0] - position[0], leg.end[2] - position[2]
            left = float(np.sqrt(east * east + north * north))
            if left >= ARRIVED or not on_ground:
                break
            self._take_next_leg()
        else:
            return
        row[Field.WALK_DIRECTION] = np.degrees(np.arctan2(east, north)) % 360.0
        row[Field.WALK_SPEED] = min(LEAP_SPEED if leg.leap else MAX_WALK_SPEED, left / seconds)
        row[Field.JUMP] = self.jumps
        self.jumps = False

    def _take_next_leg(self) -> None:
        self.leg, self.still = self.leg + 1, 0
        self.jumps = self.leg < len(self.legs) and self.legs[self.leg].jump

    def _get_unstuck(self, position: NDArray[np.float64]) -> None:
        moved = np.abs(position - self.before).max()
        self.still = self.still + 1 if moved < ARRIVED / STUCK else 0
        self.before = position.copy()
        if self.still < STUCK or self.leg >= len(self.legs):
            return
        end = self.legs[self.leg].end
        if np.hypot(end[0] - position[0], end[2] - position[2]) <= ARRIVAL and self.leg + 1 < len(self.legs):
            self._take_next_leg()  # it is as good as there
            return
        self.graph = without_edge(self.graph, self.starts[self.leg], end)
        if path := find_path(self.graph, position, self.target, straight=False):
            self._follow(path)


def without_edge(graph: NavGraph, start: Place, end: Place) -> NavGraph:
    """Return a graph without the edge between two nodes (m, soles), or the same if there is none."""
    first, last = node_near(graph, start, leave=True), node_near(graph, end, leave=False)
    if first is None or last not in graph.nodes.edges[first]:
        return graph
    edges = graph.nodes.edges.copy()
    edges[first][edges[first] == last] = NO_EDGE
    return replace(graph, nodes=graph.nodes._replace(edges=edges))
