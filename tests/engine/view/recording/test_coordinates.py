import numpy as np
import pytest
from numpy.typing import NDArray
from tests.engine.view.rotations import turned

from wildscav_engine.view.recording import coordinates

EAST, NORTH, UP = np.eye(3)  # Rerun's axes in a replay


def test_east_stays_east_and_up_becomes_the_third_axis() -> None:
    np.testing.assert_array_equal(coordinates.points(np.eye(3)), [EAST, UP, NORTH])


@pytest.mark.parametrize(
    ("yaw", "pitch", "forwards", "right"),
    [
        (0.0, 0.0, NORTH, EAST),
        (90.0, 0.0, EAST, -NORTH),  # clockwise from above
        (180.0, 0.0, -NORTH, -EAST),
        (-90.0, 0.0, -EAST, NORTH),
        (0.0, 90.0, -UP, EAST),  # a positive pitch looks down
        (90.0, -90.0, UP, -NORTH),
    ],
)
def test_a_camera_looks_where_the_agent_looks(
    yaw: float, pitch: float, forwards: NDArray[np.float64], right: NDArray[np.float64]
) -> None:
    camera = coordinates.camera_rotations(np.array([yaw]), np.array([pitch]))[0]
    looks = coordinates.points(coordinates.directions(np.array(yaw), np.array(pitch)))

    np.testing.assert_allclose(looks, forwards, atol=1e-6)
    np.testing.assert_allclose(turned(camera, np.array([0.0, 0.0, 1.0])), forwards, atol=1e-6)
    np.testing.assert_allclose(turned(camera, np.array([1.0, 0.0, 0.0])), right, atol=1e-6)


def test_triangles_keep_their_outside() -> None:
    a, b, c = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])  # from above in the game's order
    assert np.cross(b - a, c - a)[1] > 0

    corners = coordinates.points(np.array([a, b, c]))
    first, second, third = corners[coordinates.triangles(np.array([[0, 1, 2]], np.int32))[0]]

    assert np.cross(second - first, third - first)[2] > 0
