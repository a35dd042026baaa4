"""The depth camera reads what the original's did."""

import math

import numpy as np
import pytest
from tests.builders import box, flat_world
from tests.engine.sensors.scenes import read

from wildscav_engine.geometry.world import World
from wildscav_engine.sensors import DepthCamera


def wall(distance: float) -> World:
    return flat_world(80, [box((-40, -1, distance), (40, 40, distance + 1))])


def test_a_wall_ten_metres_ahead_reads_ten_in_every_pixel_above_the_horizon() -> None:
    image = read(DepthCamera(), wall(10))
    assert image.shape == (22, 38)
    assert image.dtype == np.float32
    assert image[:11] == pytest.approx(10, abs=1e-5)


def test_far_is_measured_along_the_ray() -> None:
    image = read(DepthCamera(far=11.0), wall(10), at=(0, 10, 0))
    assert image[11, 19] == pytest.approx(10, abs=1e-5)
    assert image[0, 0] == 11
    assert image[0, 37] == 11


def test_nothing_reads_far_and_the_sky_is_nothing() -> None:
    assert read(DepthCamera(), flat_world(80), pitch=-60) == pytest.approx(100)


@pytest.mark.parametrize("pitch", [90, 30])
def test_the_ground_below_reads_by_its_angle(pitch: float) -> None:
    depth = read(DepthCamera(1, 1), flat_world(80), pitch=pitch)[0, 0]
    assert depth == pytest.approx(1.5 / math.sin(math.radians(pitch)), abs=1e-5)


def test_the_field_of_view_is_60_degrees_wide() -> None:
    edge = 10 * math.tan(math.radians(30))
    left = flat_world(80, [box((-edge - 1, 0, 10), (-edge + 0.5, 5, 11))])
    image = read(DepthCamera(64, 36), left)
    assert image[17, 0] == pytest.approx(10, abs=1e-4)
    outside = flat_world(80, [box((-edge - 9, 0, 10), (-edge - 0.01, 5, 11))])
    assert read(DepthCamera(64, 36), outside)[17, 0] > 10.1


def test_columns_run_from_left_to_right_and_rows_from_top_to_bottom() -> None:
    right = read(DepthCamera(), flat_world(80, [box((2, 0, 10), (6, 5, 11))]))
    assert right[10, 30] < 20
    assert right[10, 7] > 20
    assert right[21, 7] < right[12, 7]  # lower rows look at nearer ground
