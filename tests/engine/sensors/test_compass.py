"""The compass points to the target."""

import numpy as np
import pytest
from tests.builders import make_match, place

from wildscav_engine.sensors import Compass
from wildscav_engine.simulation.match import Match

HALF = 0.7071067811865476


def navigate(target: tuple[float, float, float], yaw: float = 0.0) -> np.ndarray:
    match = make_match("navigation")
    match.state.matches.target[0] = target
    place(match, 0, (1, 0.5, -2), yaw, pitch=30)
    return Compass().read(match, [0])[0]


@pytest.mark.parametrize(
    ("target", "yaw", "reading"),
    [
        ((1, 0.5, 8), 0, (1, 0, 1, 10, 0)),  # straight ahead
        ((11, 0.5, -2), 0, (1, 1, 0, 10, 0)),  # to the right
        ((-9, 0.5, -2), 0, (1, -1, 0, 10, 0)),  # to the left
        ((1, 0.5, -12), 0, (1, 0, -1, 10, 0)),  # behind
        ((11, 0.5, -2), 90, (1, 0, 1, 10, 0)),  # who has turned to it has it ahead
        ((1, 0.5, 8), 135, (1, -HALF, -HALF, 10, 0)),
        ((4, 3.5, 2), 0, (1, 0.6, 0.8, 5, 3)),  # the distance is level, the height beside it
        ((1, -6.5, -2), 0, (1, 0, 0, 0, -7)),  # right below
    ],
)
def test_it_reads_flag_sine_cosine_distance_and_height(
    target: tuple[float, float, float], yaw: float, reading: tuple[float, ...]
) -> None:
    assert navigate(target, yaw) == pytest.approx(reading, abs=1e-6)


@pytest.mark.parametrize("track", ["gathering", "battle"])
def test_all_is_zero_where_the_track_has_no_target(track: str) -> None:
    match: Match = make_match(track)
    assert Compass().read(match, [0]).tolist() == [[0, 0, 0, 0, 0]]
