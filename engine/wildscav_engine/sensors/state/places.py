"""Where places are, relative to an agent: the target, the hot spot, and the centres of waves of supplies."""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, logarithm, sine
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.sensors.base import Column, sensor
from wildscav_engine.sensors.scalars import ScalarSensor, Write
from wildscav_engine.simulation.state import Agents, Matches
from wildscav_engine.simulation.systems.hot_spot import latest_of
from wildscav_engine.specs.rules import FRAME

INF = np.inf


@kernel
def write_direction(east: float, north: float, yaw: float, row: NDArray[np.float32]) -> float:
    """Write (2,) the direction of a level way relative to a yaw, right and ahead; return its length in m."""
    distance = np.sqrt(east * east + north * north)
    if distance > 0.0:
        row[0] = max(-1.0, min(1.0, (east * cosine(yaw) - north * sine(yaw)) / distance))
        row[1] = max(-1.0, min(1.0, (east * sine(yaw) + north * cosine(yaw)) / distance))
    return float(distance)


@kernel
def _write_compass(agents: Agents, matches: Matches, match: int, seat: int, row: NDArray[np.float32]) -> None:
    if not agents.knows_target[match, seat]:
        return
    target, position, yaw = matches.target[match], agents.position[match, seat], agents.yaw[match, seat]
    row[0], row[4] = 1.0, target[1] - position[1]
    row[3] = write_direction(target[0] - position[0], target[2] - position[2], yaw, row[1:3])


@sensor
class Compass(ScalarSensor):
    """Direction and distance of the target.

    Sine and cosine are both 0 directly above or below the target. All numbers are 0 if the track has no
    target, or while the target is hidden from the agent's team.

    Unlike an angle, the sine and cosine are continuous where the target is behind the agent.
    """

    name: ClassVar[str] = "compass"
    title: ClassVar[str] = "the target: whether there is one, sine and cosine of its bearing, m away, m up"
    scalars: ClassVar[tuple[Column, ...]] = (
        Column("known", "0 or 1", 0, 1, "whether the agent knows a target"),
        Column("sine", "", -1, 1, "sine of the target's bearing, clockwise from the view: 1 is to the right"),
        Column("cosine", "", -1, 1, "cosine of that bearing: 1 is straight ahead"),
        Column("distance", "m", 0, INF, "horizontal distance of the target"),
        Column("height", "m", -INF, INF, "height of the target above the agent's soles"),
    )

    @staticmethod
    def kernel() -> Write:
        """Return the kernel that writes the numbers."""
        return _write_compass


@kernel
def _write_places(
    agents: Agents,
    match: int,
    seat: int,
    places: NDArray[np.float64],
    frame: int,
    is_turned: bool,
    row: NDArray[np.float32],
) -> None:
    """Write (9,) the latest of some places, the next one, and the s until that comes, into zeros.

    ``places`` are (N, 3) the frame in which each comes, in ascending order, and its x and z in m; and
    ``is_turned`` says whether networks read the row, as ``_write_place`` explains.
    """
    latest = latest_of(places, frame)
    if latest >= 0:
        _write_place(agents, match, seat, places[latest], is_turned, row[:4])
    following = latest + 1
    if following < places.shape[0]:
        _write_place(agents, match, seat, places[following], is_turned, row[4:8])
        row[8] = (places[following, 0] - frame) * FRAME


@kernel
def _write_place(
    agents: Agents,
    match: int,
    seat: int,
    place: NDArray[np.float64],
    is_turned: bool,
    row: NDArray[np.float32],
) -> None:
    """Write (4,) 1, the way to a place, and its length.

    Networks read the way relative to the agent's yaw, its parts of 1, and the logarithm of 1 m + its length;
    otherwise it is in the axes of the world, in m.
    """
    east, north = place[1] - agents.position[match, seat, 0], place[2] - agents.position[match, seat, 2]
    row[0] = 1.0
    if is_turned:
        row[3] = logarithm(1.0 + write_direction(east, north, agents.yaw[match, seat], row[1:3]))
    else:
        row[1], row[2], row[3] = east, north, np.sqrt(east * east + north * north)


@kernel
def _write_hot_spot(
    agents: Agents, matches: Matches, match: int, seat: int, row: NDArray[np.float32]
) -> None:
    places = matches.hot_spots[match, : matches.places[match]]
    _write_places(agents, match, seat, places, matches.frame[match], False, row)


@sensor
class HotSpotSensor(ScalarSensor):
    """The hot spot, a rich place that moves: where it is, where it comes next, and when.

    The first four numbers are 0 before it comes to its first place, the others from its last place on. All
    are 0 if the match has no hot spot.
    """

    name: ClassVar[str] = "hot_spot"
    title: ClassVar[str] = (
        "the hot spot: whether it is at a place, that place from the agent and its distance, m; the same of "
        "the next place; s until it comes there"
    )
    scalars: ClassVar[tuple[Column, ...]] = (
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

    @staticmethod
    def kernel() -> Write:
        """Return the kernel that writes the numbers."""
        return _write_hot_spot


@kernel
def _write_to_hot_spot(
    agents: Agents, matches: Matches, match: int, seat: int, row: NDArray[np.float32]
) -> None:
    places = matches.hot_spots[match, : matches.places[match]]
    _write_places(agents, match, seat, places, matches.frame[match], True, row)


@sensor
class ToHotSpot(ScalarSensor):
    """The ways to the hot spot and to its next place, relative to the agent's yaw.

    What is not known is 0, as in the sensor ``hot_spot``.
    """

    name: ClassVar[str] = "to_hot_spot"
    title: ClassVar[str] = (
        "the way to the hot spot: known, right, ahead, log distance, ln m; the same of its next place; s "
        "until it comes there"
    )
    scalars: ClassVar[tuple[Column, ...]] = (
        Column("here", "0 or 1", 0, 1, "whether the hot spot is at a place"),
        Column("right", "of 1", -1, 1, "the way there: its part to the right of the yaw"),
        Column("ahead", "of 1", -1, 1, "the same way's part along the yaw"),
        Column("log distance", "ln m", 0, 10, "logarithm of 1 m + the horizontal distance"),
        Column("next", "0 or 1", 0, 1, "whether it comes to another place"),
        Column("next right", "of 1", -1, 1, "the way to the next place: its part to the right of the yaw"),
        Column("next ahead", "of 1", -1, 1, "the same way's part along the yaw"),
        Column("next log distance", "ln m", 0, 10, "logarithm of 1 m + the horizontal distance"),
        Column("comes_in", "s", 0, INF, "time until it comes to its next place"),
    )

    @staticmethod
    def kernel() -> Write:
        """Return the kernel that writes the numbers."""
        return _write_to_hot_spot


@kernel
def _write_to_waves(
    agents: Agents, matches: Matches, match: int, seat: int, row: NDArray[np.float32]
) -> None:
    places = matches.wave_centers[match, : matches.waves[match]]
    _write_places(agents, match, seat, places, matches.frame[match], True, row)


@sensor
class ToWaves(ScalarSensor):
    """The ways to the centres of the latest wave of supplies and of the next one, relative to the yaw.

    What is not known is 0. The places of the hot spot are among the waves, as in what all agents are told
    before the match.
    """

    name: ClassVar[str] = "to_waves"
    title: ClassVar[str] = (
        "the way to the latest wave's centre: appeared, right, ahead, log distance, ln m; the same of the "
        "next wave; s until it appears"
    )
    scalars: ClassVar[tuple[Column, ...]] = (
        Column("appeared", "0 or 1", 0, 1, "whether a wave has appeared"),
        Column(
            "right", "of 1", -1, 1, "the way to the latest one's centre: its part to the right of the yaw"
        ),
        Column("ahead", "of 1", -1, 1, "the same way's part along the yaw"),
        Column("log distance", "ln m", 0, 10, "logarithm of 1 m + the horizontal distance"),
        Column("next", "0 or 1", 0, 1, "whether there will be another wave"),
        Column(
            "next right", "of 1", -1, 1, "the way to the next one's centre: its part to the right of the yaw"
        ),
        Column("next ahead", "of 1", -1, 1, "the same way's part along the yaw"),
        Column("next log distance", "ln m", 0, 10, "logarithm of 1 m + the horizontal distance"),
        Column("comes_in", "s", 0, INF, "time until the next wave appears"),
    )

    @staticmethod
    def kernel() -> Write:
        """Return the kernel that writes the numbers."""
        return _write_to_waves
