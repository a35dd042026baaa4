"""The normals camera tells which way surfaces face."""

import math

import numpy as np
import pytest
from tests.builders import box, flat_world, map_from
from tests.engine.sensors.scenes import read

from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.maps import generate_map
from wildscav_engine.sensors import DepthCamera, NormalCamera
from wildscav_engine.specs.map_spec import MapConfig


def test_a_wall_faces_who_looks_at_it_and_the_sky_faces_nowhere() -> None:
    image = read(NormalCamera(39, 21), flat_world(80, [box((-2, 0, 10), (2, 3, 11))]))
    assert image.shape == (21, 39, 3)
    assert image[10, 19].tolist() == [0, 0, -1]
    assert image[0, 0].tolist() == [0, 0, 0]
    assert image[20, 19].tolist() == [0, 1, 0]


@pytest.mark.parametrize(("yaw", "normal"), [(0, (0, 0, -1)), (90, (-1, 0, 0)), (-90, (1, 0, 0))])
def test_normals_are_in_the_axes_of_the_world(yaw: float, normal: tuple[int, int, int]) -> None:
    walls = [box((-9, 0, 8), (9, 5, 9)), box((8, 0, -9), (9, 5, 7)), box((-9, 0, -9), (-8, 5, 7))]
    assert tuple(read(NormalCamera(3, 3), flat_world(80, walls), yaw)[1, 1]) == normal


def test_a_slope_leans_back_from_its_rise() -> None:
    normal = read(NormalCamera(1, 1), flat_world(80, slope=0.5), pitch=90)[0, 0]
    assert normal == pytest.approx([-0.5 / math.sqrt(1.25), 1 / math.sqrt(1.25), 0], abs=1e-6)


def test_what_is_beyond_far_has_no_normal() -> None:
    wall = flat_world(80, [box((-9, 0, 10), (9, 9, 11))])
    assert not read(NormalCamera(3, 1, far=9.9), wall)[0, 1].any()


def test_ground_is_at_right_angles_to_its_triangle() -> None:
    """Seen from above, against the rise of the ground a millimetre aside."""
    country = generate_map(MapConfig(size=60, houses=0, vegetation=0, water=0), 4)
    random = np.random.default_rng(1)
    x, z = random.uniform(-29, 29, (2, 200))
    eyes = np.column_stack((x, np.full(200, 90.0), z))
    normals = NormalCamera(1, 1, far=300).render(country, eyes, np.zeros(200), np.full(200, 90.0))[:, 0, 0]

    def rise(east: float, north: float) -> np.ndarray:
        world, aside = country.world, 1e-3
        places = list(zip(x, z, strict=True))
        there = [ground_at(world, a + east * aside, b + north * aside).height for a, b in places]
        return (np.array(there) - [ground_at(world, a, b).height for a, b in places]) / aside

    right = np.column_stack((-rise(1, 0), np.ones(200), -rise(0, 1)))
    right /= np.linalg.norm(right, axis=1)[:, None]
    agrees = np.abs(normals - right).max(axis=1) < 1e-4
    assert agrees.mean() > 0.98  # all but those within a millimetre of an edge
    assert np.ptp(normals[:, 0]) > 0.1


def test_normals_are_of_length_one_just_where_depth_is_less_than_far() -> None:
    country = generate_map(MapConfig(size=60, houses=2), 3)
    eyes = country.outdoor[::50][:20] + np.array((0, 1.5, 0))
    yaws, pitches = np.linspace(-180, 180, len(eyes)), np.linspace(-30, 30, len(eyes))
    lengths = np.linalg.norm(NormalCamera(far=40).render(country, eyes, yaws, pitches), axis=-1)
    depths = DepthCamera(far=40).render(country, eyes, yaws, pitches)
    assert lengths[lengths > 0] == pytest.approx(1, abs=1e-6)
    np.testing.assert_array_equal(lengths > 0, depths < 40)
    assert 0.1 < (lengths > 0).mean() < 0.99


def test_normals_have_none_inside_of_something() -> None:
    inside = map_from(flat_world(80, [box((-1, 0, -1), (1, 3, 1))]))
    assert not NormalCamera(3, 3).render(inside, [(0, 1, 0)], [0], [0]).any()
