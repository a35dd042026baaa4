"""The depth camera reads what the original's did."""

import math
from typing import Any

import numpy as np
import pytest
from tests.builders import box, flat_world, make_match, place

from wildscav_engine.geometry.world import World
from wildscav_engine.sensors import DepthCamera, parse_sensor


def read(
    world: World, position: tuple[float, float, float], yaw: float, pitch: float, **options: Any
) -> np.ndarray:
    match = make_match(world=world)
    place(match, 0, position, yaw, pitch)
    return DepthCamera(**options).read(match, [0])[0]


def wall(distance: float) -> World:
    return flat_world(80, [box((-40, -1, distance), (40, 40, distance + 1))])


def test_a_wall_ten_metres_ahead_reads_ten_in_every_pixel_above_the_horizon() -> None:
    image = read(wall(10), (0, 0, 0), 0, 0)
    assert image.shape == (22, 38)
    assert image.dtype == np.float32
    assert image[:11] == pytest.approx(10, abs=1e-5)


def test_far_is_measured_along_the_ray() -> None:
    image = read(wall(10), (0, 10, 0), 0, 0, far=11.0)
    assert image[11, 19] == pytest.approx(10, abs=1e-5)
    assert image[0, 0] == 11
    assert image[0, 37] == 11


def test_nothing_reads_far_and_the_sky_is_nothing() -> None:
    assert read(flat_world(80), (0, 0, 0), 0, -60) == pytest.approx(100)


def test_the_ground_below_reads_by_its_angle() -> None:
    image = read(flat_world(80), (0, 0, 0), 0, 90, width=1, height=1)
    assert image[0, 0] == pytest.approx(1.5)
    image = read(flat_world(80), (0, 0, 0), 0, 30, width=1, height=1)
    assert image[0, 0] == pytest.approx(1.5 / math.sin(math.radians(30)), abs=1e-5)


def test_the_field_of_view_is_60_degrees_wide() -> None:
    edge = 10 * math.tan(math.radians(30))
    left = flat_world(80, [box((-edge - 1, 0, 10), (-edge + 0.5, 5, 11))])
    image = read(left, (0, 0, 0), 0, 0, width=64, height=36)
    assert image[17, 0] == pytest.approx(10, abs=1e-4)
    outside = flat_world(80, [box((-edge - 9, 0, 10), (-edge - 0.01, 5, 11))])
    assert read(outside, (0, 0, 0), 0, 0, width=64, height=36)[17, 0] > 10.1


def test_columns_run_from_left_to_right_and_rows_from_top_to_bottom() -> None:
    right = read(flat_world(80, [box((2, 0, 10), (6, 5, 11))]), (0, 0, 0), 0, 0)
    assert right[10, 30] < 20
    assert right[10, 7] > 20
    assert right[21, 7] < right[12, 7]  # lower rows look at nearer ground


def test_other_agents_are_not_in_it() -> None:
    match = make_match(seats=2)
    place(match, 0, (0, 0, 0))
    alone = DepthCamera().read(match, [0])
    place(match, 1, (0, 0, 5))
    assert (DepthCamera().read(match, [0]) == alone).all()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"width": 0}, "width: Input should be greater than or equal to 1, not 0"),
        ({"far": -1}, "far"),
        ({"wide": 3}, "wide"),
        ({"height": "tall"}, "height"),
    ],
)
def test_wrong_options_are_named_in_one_line(options: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match="sensor depth") as caught:
        parse_sensor("depth", options)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)
