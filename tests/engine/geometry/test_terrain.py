"""Heights, slopes and water of the ground: quads of 2 m, split from the south-west to the north-east."""

import math

import numpy as np
import pytest
from tests.builders import flat_world

from wildscav_engine.geometry.terrain import Ground, ground_at, is_steep, water_at
from wildscav_engine.geometry.world import World, build_world

DRY = -math.inf


def one_quad(south_west: float, south_east: float, north_west: float, north_east: float) -> World:
    """A map of one quad, from (0, 0) to (2, 2), with water up to 1.5 m."""
    heights = np.array([[south_west, south_east], [north_west, north_east]], float)
    return build_world((0.0, 0.0), heights, np.full((1, 1), 1.5), (), np.zeros((1, 3)))


@pytest.mark.parametrize(
    ("x", "z", "ground"),
    [
        (0.0, 0.0, Ground(0.0, 0.5, 2.0, 1.5)),
        (2.0, 0.0, Ground(1.0, 0.5, 2.0, 1.5)),
        (2.0, 2.0, Ground(5.0, 0.5, 2.0, DRY)),
        (1.0, 1.0, Ground(2.5, 0.5, 2.0, DRY)),  # the middle lies on the diagonal, with the south-east
        (1.5, 0.5, Ground(1.75, 0.5, 2.0, DRY)),  # south-east: 0.5 m a metre east, then 2 m a metre north
        (0.5, 1.5, Ground(2.75, 1.0, 1.5, DRY)),  # north-west: 1.5 m a metre north, then 1 m a metre east
        (0.5, 0.6, Ground(1.4, 1.0, 1.5, 1.5)),
        (3.0, 0.0, Ground(1.5, 0.5, 2.0, DRY)),  # outside, the edge goes on: here at the water's height
        (0.0, -1.0, Ground(-2.0, 0.5, 2.0, 1.5)),
    ],
)
def test_ground_is_the_plane_of_a_triangle(x: float, z: float, ground: Ground) -> None:
    world = one_quad(0.0, 1.0, 3.0, 5.0)

    assert ground_at(world, x, z) == pytest.approx(ground)
    assert water_at(world, x, z) == ground.water


def test_both_triangles_meet_along_the_diagonal() -> None:
    world = one_quad(0.0, 1.0, 3.0, 5.0)

    for along in np.linspace(0.0, 2.0, 21):
        assert ground_at(world, along, along).height == pytest.approx(2.5 * along)
        assert ground_at(world, along, along + 1e-9).height == pytest.approx(2.5 * along, abs=1e-8)


@pytest.mark.parametrize(
    ("slope_x", "slope_z", "steep"),
    [
        (0.0, 0.0, False),
        (1.0, 0.0, False),  # 45 degrees can be stood on
        (1.001, 0.0, True),
        (0.0, -1.001, True),
        (0.7, 0.7, False),  # 0.99 m a metre, north-eastwards
        (0.8, 0.61, True),  # 1.006 m a metre
    ],
)
def test_more_than_45_degrees_is_steep(slope_x: float, slope_z: float, steep: bool) -> None:
    assert is_steep(Ground(0.0, slope_x, slope_z, DRY)) is steep


def test_a_slope_of_a_whole_map_is_the_same_everywhere() -> None:
    world = flat_world(40, slope=0.25, water=1.0)

    for x, z in np.random.default_rng(1).uniform(-20, 20, (50, 2)):
        ground = ground_at(world, x, z)
        assert ground[:3] == pytest.approx((0.25 * x, 0.25, 0.0), abs=1e-9)
        assert ground.water == (1.0 if x < 4.0 else DRY)
