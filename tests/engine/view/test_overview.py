"""The free view has the whole map in it."""

import numpy as np
import pytest
from tests.builders import flat_world, make_match, place

from wildscav_engine.view.overview import ASPECT, VIEW_ANGLE, WHOLE_MAP, Overview, overview
from wildscav_engine.view.recording.history import collect_history


def on_screen(camera: Overview, points: np.ndarray) -> np.ndarray:
    """Where (N, 3) points are in the picture: -1 to 1 across and up are inside."""
    ahead = camera.target - camera.eye
    ahead /= np.linalg.norm(ahead)
    right = np.cross([0.0, 1.0, 0.0], ahead)
    right /= np.linalg.norm(right)
    offsets = points - camera.eye
    depth = offsets @ ahead
    assert (depth > 0).all()
    tall = np.tan(np.radians(VIEW_ANGLE) / 2)
    across, up = offsets @ right / (tall * ASPECT), offsets @ np.cross(ahead, right) / tall
    return np.stack([across, up], -1) / depth[:, None]


@pytest.mark.parametrize("size", [40, 100, 500])
@pytest.mark.parametrize("slope", [0.0, 0.3])
def test_every_corner_of_the_map_is_in_view_and_the_map_fills_it(size: int, slope: float) -> None:
    world = flat_world(size=size, slope=slope)
    match = make_match("battle", world=world, seats=1, time_limit=60.0)
    _, history = collect_history(iter([match]), 0, images_of=None)

    corners = [(x, x * slope, z) for x in (-size / 2, size / 2) for z in (-size / 2, size / 2)]
    seen = on_screen(overview(history, world), np.array(corners))

    assert np.abs(seen).max() < 1.0
    if size > 60:
        assert np.ptp(seen, axis=0).max() > 1.6  # of 2


def test_of_a_huge_map_all_that_moves_is_in_view() -> None:
    world = flat_world(size=int(WHOLE_MAP) + 100)
    match = make_match("battle", world=world, seats=2, time_limit=60.0)
    place(match, 0, (100.0, 0.0, 200.0))
    place(match, 1, (240.0, 0.0, 150.0))
    _, history = collect_history(iter([match]), 0, images_of=None)

    camera = overview(history, world)

    assert np.abs(on_screen(camera, history.agents.position[0])).max() < 1.0
    assert np.linalg.norm(camera.eye - [170.0, 0.0, 175.0]) < 300
