"""Bodies in a replay are those that agents see."""

import numpy as np
import pytest
from tests.engine.view.rotations import turned

from wildscav_engine.sensors.optics.dynamic_objects import placed_objects
from wildscav_engine.view.entities.agents import body_colors, body_mesh, poses
from wildscav_engine.view.recording import coordinates


@pytest.mark.parametrize("yaw", [0.0, 90.0, -35.0])
def test_a_figure_is_where_the_cameras_see_the_agent(yaw: float) -> None:
    seen = placed_objects([((0.0, 0.0, 0.0), yaw)], [])
    rotations, offsets = poses(np.array([yaw]), np.array([False]))
    shown = np.array([turned(rotations[0], corner) for corner in body_mesh().positions]) + offsets[0]

    apart = np.linalg.norm(shown[:, None] - coordinates.points(seen.corners)[None], axis=-1)
    assert apart.min(axis=0).max() < 1e-5
    assert apart.min(axis=1).max() < 1e-5


def test_a_figure_wears_the_colours_that_the_cameras_show() -> None:
    seen = placed_objects([((0.0, 0.0, 0.0), 0.0), ((9.0, 0.0, 0.0), 0.0)], [])
    parts = len(seen.color) // 2

    np.testing.assert_allclose(body_colors(1).usual[::24], seen.color[parts:], atol=0.5)
    assert (body_colors(1).invincible >= body_colors(1).usual).all()


def test_every_side_of_a_figure_faces_outwards() -> None:
    body = body_mesh()
    corners = body.positions.reshape(-1, 24, 3)  # of each part
    outwards = body.positions.reshape(-1, 4, 3).mean(axis=1) - np.repeat(corners.mean(axis=1), 6, axis=0)

    assert ((body.normals[::4] * outwards).sum(axis=-1) > 0).all()
    np.testing.assert_allclose(np.linalg.norm(body.normals, axis=-1), 1.0, atol=1e-6)


def test_the_dead_lie_on_their_backs() -> None:
    rotations, offsets = poses(np.array([0.0]), np.array([True]))

    head = turned(rotations[0], np.array([0.0, 0.0, 1.7])) + offsets[0]
    front = turned(rotations[0], np.array([0.0, 1.0, 0.0]))

    np.testing.assert_allclose(head, [0.0, -1.7, 0.2], atol=1e-6)  # fallen backwards from looking north
    np.testing.assert_allclose(front, [0.0, 0.0, 1.0], atol=1e-6)
