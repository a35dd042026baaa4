"""The LIDAR measures all round, level whatever the agent looks at."""

import math
from typing import Any

import numpy as np
import pytest
from tests.builders import box, flat_world, make_match, map_from, place

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.geometry.rays import raycast
from wildscav_engine.geometry.world import World
from wildscav_engine.maps import generate_map
from wildscav_engine.rendering.tracing.solids import gather_solids
from wildscav_engine.sensors import DepthCamera, Lidar
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.specs.map_spec import MapConfig

RING = {"channels": 1, "lowest": 0.0, "highest": 0.0}  # one level ring


def scan(world: World, yaw: float = 0.0, pitch: float = 0.0, **options: Any) -> np.ndarray:
    match = make_match(world=world)
    place(match, 0, (0, 0, 0), yaw, pitch)
    return Lidar(**options).read(match, [0])[0]


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
    distances = scan(post(*place_of_post), yaw, **RING)[0]
    assert int(distances.argmin()) == column
    assert distances[column] == pytest.approx(9.9)


def test_where_nothing_is_met_it_reads_the_range() -> None:
    assert scan(flat_world(80), range=33.5, **RING) == pytest.approx(33.5)
    assert scan(post(0, 10), range=9.8, **RING).min() == np.float32(9.8)


def test_rows_run_from_the_highest_ring_to_the_lowest() -> None:
    rings = scan(flat_world(80), channels=3, lowest=-30.0, highest=30.0)
    assert (rings[0] == 100).all()
    assert (rings[1] == 100).all()
    assert rings[2] == pytest.approx(EYE_HEIGHT / math.sin(math.radians(30)), abs=1e-5)


def test_a_single_ring_is_halfway_between_the_lowest_and_the_highest() -> None:
    ring = scan(flat_world(80), channels=1, lowest=-50.0, highest=-10.0)
    assert ring[0] == pytest.approx(EYE_HEIGHT / math.sin(math.radians(30)), abs=1e-5)


@pytest.mark.parametrize("pitch", [-90.0, -20.0, 45.0])
def test_the_pitch_changes_nothing(pitch: float) -> None:
    assert scan(post(3, 10), 20, pitch).tobytes() == scan(post(3, 10), 20).tobytes()


def test_it_agrees_with_the_depth_camera_straight_ahead() -> None:
    country = generate_map(MapConfig(size=60, houses=2), 3)
    random = np.random.default_rng(0)
    eyes = country.outdoor[random.choice(len(country.outdoor), 40)] + (0, EYE_HEIGHT, 0)
    yaws, level = random.uniform(-180, 180, 40), np.zeros(40)
    depth = DepthCamera(1, 1).render(country, eyes, yaws, level)
    rings = Lidar(azimuths=8, **RING).render(country, eyes, yaws, level)
    assert rings[:, 0, :1] == pytest.approx(depth[:, 0], abs=1e-4)
    assert len(np.unique(depth)) > 10


@pytest.mark.parametrize("highest", [15.0, 90.0])
def test_every_ray_meets_what_the_one_ray_kernel_says(highest: float) -> None:
    """In the open, in houses, outside the map, underground, along cells; all round, straight up and down."""
    country = generate_map(MapConfig(size=100, relief=1.5, houses=4, water=0.1, vegetation=0.8), 3)
    random = np.random.default_rng(1)
    feet = [some[random.choice(len(some), 12)] for some in (country.outdoor, country.indoor)]
    odd = [(60.0, 5.0, 0.0), (1.0, -99.0, 1.0), (0.0, 40.0, -0.5), (4.0, 3.0, 8.0)]
    eyes = np.concatenate([*feet, odd])
    eyes[:, 1] += EYE_HEIGHT
    yaws = random.choice((-45.0, 0.0, 90.0, 33.3), len(eyes))
    lidar = Lidar(channels=15, azimuths=40, range=70.0, lowest=-highest, highest=highest)

    rings = lidar.render(country, eyes, yaws, np.zeros(len(eyes)))

    azimuths = yaws[:, None] + np.arange(40) * 9.0
    for image, channel, column in np.ndindex(rings.shape):
        rise, azimuth = lidar.elevations[channel], azimuths[image, column]
        level = cosine(rise)
        way = (sine(azimuth) * level, sine(rise), cosine(azimuth) * level)
        expected = min(70.0, raycast(country.world, *eyes[image], *way, 70.0).distance)
        assert rings[image, channel, column] == pytest.approx(expected, abs=1e-5), (image, channel, column)


def test_agents_are_met_only_when_they_are_asked_for_and_never_oneself() -> None:
    match = make_match(seats=2, world=flat_world(80))
    place(match, 0, (0, 0, 0))
    place(match, 1, (-5, 0, 0), yaw=90)  # to the left
    assert (Lidar(**RING).read(match, [0]) == 100).all()
    ring = Lidar(moving=True, **RING).read(match, [0])[0, 0]
    assert int(ring.argmin()) == pytest.approx(270, abs=3)
    assert 4.5 < ring.min() < 5.0
    assert (ring[:265] == 100).all()
    assert (ring[276:] == 100).all()


def test_whoever_has_died_is_met_no_more() -> None:
    match = make_match(seats=2, world=flat_world(80))
    place(match, 0, (0, 0, 0))
    place(match, 1, (0, 0, 5))
    match.state.agents.health[0, 1] = 0
    assert (Lidar(moving=True, **RING).read(match, [0]) == 100).all()


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


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"lowest": 10, "highest": -10}, "lowest is 10, must not be above highest, -10"),
        ({"channels": 0}, "channels: Input should be greater than or equal to 1, not 0"),
        ({"azimuths": 4000}, "azimuths: Input should be less than or equal to 3600"),
        ({"range": float("inf")}, "range: Input should be a finite number"),
        ({"highest": 91}, "highest: Input should be less than or equal to 90"),
    ],
)
def test_wrong_options_are_named_in_one_line(options: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match="sensor lidar: ") as caught:
        Lidar(**options)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)
