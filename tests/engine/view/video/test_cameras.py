"""The camera above everybody of a match that is being played."""

import numpy as np
import pytest

from wildscav_engine.maps.generate import generate_map
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.view.video.cameras import LiveAbove

WIDTH, HEIGHT = 640, 360  # pixels
WORLD = generate_map(MapConfig(size=120, houses=2), seed=1).world


def spread(seed: int, extent: float) -> np.ndarray:
    """Return (6, 3) m, places on the map."""
    places = np.random.default_rng(seed).uniform(-extent, extent, (6, 3))
    places[:, 1] = 5.0
    return places


@pytest.mark.parametrize("extent", [1.0, 20.0, 55.0])
def test_everybody_is_in_view(extent: float) -> None:
    places = spread(1, extent)
    across, down, depth = LiveAbove(WORLD, WIDTH / HEIGHT).at(places, 0.0).onto(places, WIDTH, HEIGHT).T
    assert (depth > 0.0).all()
    assert ((across > 0) & (across < WIDTH) & (down > 0) & (down < HEIGHT)).all()


def test_the_camera_glides_and_arrives() -> None:
    camera = LiveAbove(WORLD, WIDTH / HEIGHT)
    before = camera.at(spread(1, 10.0), 0.0).eye
    after = camera.at(spread(2, 50.0), 0.05).eye
    assert 0.0 < np.linalg.norm(after - before) < 5.0  # m, in 50 ms
    last = camera.at(spread(2, 50.0), 60.0).eye
    assert np.allclose(last, LiveAbove(WORLD, WIDTH / HEIGHT).at(spread(2, 50.0), 0.0).eye, atol=0.1)


def test_it_stays_where_it_is_when_nobody_is_alive() -> None:
    camera = LiveAbove(WORLD, WIDTH / HEIGHT)
    eye = camera.at(spread(1, 10.0), 0.0).eye
    assert np.array_equal(camera.at(np.zeros((0, 3)), 1.0).eye, eye)
    assert np.isfinite(LiveAbove(WORLD, WIDTH / HEIGHT).at(np.zeros((0, 3)), 0.0).eye).all()
