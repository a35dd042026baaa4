"""The LIDAR measures all round, level whatever the agent looks at."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.builders import box, flat_world, map_from
from tests.engine.sensors.scenes import read

from wildscav_engine.geometry.world import World
from wildscav_engine.maps import generate_map
from wildscav_engine.rendering.tracing.solids import gather_solids
from wildscav_engine.sensors import DepthCamera, Lidar
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.specs.map_spec import MapConfig

RING = Lidar(1, lowest=0.0, highest=0.0)  # a level one


def post(x: float, z: float) -> World:
    """A thin post in a wide plain."""
    return flat_world(80, [box((x - 0.1, 0, z - 0.1), (x + 0.1, 5, z + 0.1))])


@pytest.mark.parametrize(
    ("place_of_post", "yaw", "column"),
    [
        ((0, 10), 0, 0),  # straight ahead
        ((10, 0), 0, 90),  # to the right: azimuths grow clockwise
        ((0, -10), 0, 180),
        ((-10, 0), 0, 270),
        ((10, 0), 90, 0),  # column 0 looks along the yaw
        ((0, 10), 90, 270),
    ],
)
def test_azimuths_grow_clockwise_from_the_yaw(
    place_of_post: tuple[float, float], yaw: float, column: int
) -> None:
    distances = read(RING, post(*place_of_post), yaw)[0]
    assert int(distances.argmin()) == column
    assert distances[column] == pytest.approx(9.9)


def test_where_nothing_is_met_it_reads_the_range() -> None:
    assert read(replace(RING, range=33.5), flat_world(80)) == pytest.approx(33.5)
    assert read(replace(RING, range=9.8), post(0, 10)).min() == np.float32(9.8)


def test_rows_run_from_the_highest_ring_to_the_lowest_and_a_single_one_is_halfway() -> None:
    rings = read(Lidar(3, lowest=-30.0, highest=30.0), flat_world(80))
    assert (rings[:2] == 100).all()
    assert rings[2] == pytest.approx(EYE_HEIGHT / math.sin(math.radians(30)), abs=1e-5)
    assert read(Lidar(1, lowest=-50.0, highest=-10.0), flat_world(80))[0] == pytest.approx(rings[2], abs=1e-5)


@pytest.mark.parametrize("pitch", [-90.0, -20.0, 45.0])
def test_the_pitch_changes_nothing(pitch: float) -> None:
    assert read(Lidar(), post(3, 10), 20, pitch).tobytes() == read(Lidar(), post(3, 10), 20).tobytes()


def test_it_agrees_with_the_depth_camera_straight_ahead() -> None:
    country = generate_map(MapConfig(size=60, houses=2), 3)
    random = np.random.default_rng(0)
    eyes = country.outdoor[random.choice(len(country.outdoor), 40)] + (0, EYE_HEIGHT, 0)
    yaws, level = random.uniform(-180, 180, 40), np.zeros(40)
    depth = DepthCamera(1, 1).render(country, eyes, yaws, level)
    rings = replace(RING, azimuths=8).render(country, eyes, yaws, level)
    assert rings[:, 0, :1] == pytest.approx(depth[:, 0], abs=1e-4)
    assert len(np.unique(depth)) > 10


def test_what_moves_is_met_like_the_same_thing_in_the_world() -> None:
    """Boxes all round, one across the seam of the panorama and one around the eye of a viewer."""
    corners = [(-0.5, 0.0, 4.0), (6.0, 1.0, -3.0), (-9.0, -2.0, -9.0), (1.0, 0.5, 30.0), (19.0, 0.0, 19.0)]
    boxes = [box(low, np.add(low, (1.3, 2.2, 1.7))) for low in corners]
    eyes = [(0.0, 1.5, 0.0), (3.0, 1.0, -4.0), (19.5, 1.0, 19.5)]
    yaws, pitches = [0.0, -170.0, 77.7], np.zeros(3)
    lidar = Lidar(azimuths=123, range=60.0, lowest=-40.0, highest=30.0)

    still = lidar.render(map_from(flat_world(80, boxes)), eyes, yaws, pitches)
    moved = lidar.render(map_from(flat_world(80)), eyes, yaws, pitches, moving=gather_solids(boxes))

    np.testing.assert_allclose(moved, still, atol=1e-5)
    assert (still[2] == 0).all()
