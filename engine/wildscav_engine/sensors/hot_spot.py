"""The hot spot: where it is, where it comes next, and when.

Nine numbers: 1 if the hot spot is at a place; that place relative to the agent (x east and z north, m) and
its horizontal distance (m); the same four numbers of the next place; and the time until the hot spot comes
there (s). The first four are 0 before it comes to its first place, the others from its last place on. All are
0 if the match has no hot spot.
"""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.sensors.base import Column, sensor
from wildscav_engine.sensors.scalars import ScalarSensor, Write
from wildscav_engine.simulation.state import Agents, Matches
from wildscav_engine.simulation.systems.hot_spot import hot_spot_at
from wildscav_engine.specs.rules import FRAME

INF = np.inf
COLUMNS = (
    Column("here", "0 or 1", 0, 1, "whether the hot spot is at a place"),
    Column("x", "m", -INF, INF, "its place, east of the agent"),
    Column("z", "m", -INF, INF, "its place, north of the agent"),
    Column("distance", "m", 0, INF, "horizontal distance of its place"),
    Column("next", "0 or 1", 0, 1, "whether it comes to another place"),
    Column("next_x", "m", -INF, INF, "its next place, east of the agent"),
    Column("next_z", "m", -INF, INF, "its next place, north of the agent"),
    Column("next_distance", "m", 0, INF, "horizontal distance of its next place"),
    Column("comes_in", "s", 0, INF, "time until it comes to its next place"),
)


@kernel
def _write_place(position: NDArray[np.float64], x: float, z: float, row: NDArray[np.float32]) -> None:
    """Write (4,) what an agent knows about a place of the hot spot."""
    to_x, to_z = x - position[0], z - position[2]
    row[0] = 1.0
    row[1], row[2], row[3] = to_x, to_z, np.sqrt(to_x * to_x + to_z * to_z)


@kernel
def _write_hot_spot(
    agents: Agents, matches: Matches, match: int, seat: int, row: NDArray[np.float32]
) -> None:
    """Write what a seat knows about the hot spot; all 0 if there is none."""
    frame, position = matches.frame[match], agents.position[match, seat]
    place = hot_spot_at(matches, match, frame)
    if place.number >= 0:
        _write_place(position, place.x, place.z, row[:4])
    following = place.number + 1
    if following < matches.places[match]:
        come = matches.hot_spots[match, following]
        _write_place(position, come[1], come[2], row[4:8])
        row[8] = (come[0] - frame) * FRAME


@sensor
class HotSpotSensor(ScalarSensor):
    """The hot spot, a rich place that moves, and its next place."""

    name: ClassVar[str] = "hot_spot"
    title: ClassVar[str] = (
        "the hot spot: whether it is at a place, that place from the agent and its distance, m; the same of "
        "the next place; s until it comes there"
    )
    scalars: ClassVar[tuple[Column, ...]] = COLUMNS

    @staticmethod
    def kernel() -> Write:
        """Return the kernel that writes the numbers."""
        return _write_hot_spot
