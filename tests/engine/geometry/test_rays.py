"""What a ray hits, compared with results by hand and by brute force."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.builders import box, flat_world

from wildscav_engine.geometry import rays
from wildscav_engine.geometry.rays import (
    NOTHING_HIT,
    TERRAIN_HIT,
    intersect_solid,
    make_ray,
    raycast,
    sight_is_clear,
)
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import World
from wildscav_engine.maps import generate_map
from wildscav_engine.specs.map_spec import MapConfig

WALL = box((-2, 0, 10), (2, 3, 11))
HALF = math.sqrt(0.5)


@pytest.mark.parametrize(
    ("start", "direction", "distance", "solid"),
    [
        ((0, 1.5, 0), (0, 0, 1), 10, 0),  # straight at the wall
        ((0, 1.5, 0), (0, 0, -1), math.inf, NOTHING_HIT),  # away from it
        ((0, 1.5, 0), (0, -1, 0), 1.5, TERRAIN_HIT),  # straight down
        ((0, 1.5, 0), (0, 1, 0), math.inf, NOTHING_HIT),  # straight up
        ((0, 4, 0), (0, 0, 1), math.inf, NOTHING_HIT),  # above the wall
        ((0, 4, 10.5), (0, -1, 0), 1, 0),  # down onto its top
        ((5, 1.5, 5.5), (-HALF, 0, HALF), 4.5 * math.sqrt(2), 0),  # slanting
        ((0, 1.5, 10.5), (0, 0, 1), 0, 0),  # from inside
        ((0, 1.5, 30), (0, 0, -1), math.inf, NOTHING_HIT),  # from outside the map
    ],
)
def test_what_a_ray_meets(
    start: tuple[float, ...], direction: tuple[float, ...], distance: float, solid: int
) -> None:
    world = flat_world(40, [WALL])
    hit = raycast(world, *map(float, start), *map(float, direction), 100.0)
    assert hit.distance == pytest.approx(distance, abs=1e-9)
    assert hit.solid == solid


def test_nothing_is_hit_beyond_far() -> None:
    world = flat_world(40, [WALL])
    assert raycast(world, 0.0, 1.5, 0.0, 0.0, 0.0, 1.0, 9.99).solid == NOTHING_HIT


def test_a_wall_between_two_points_blocks_sight_and_a_gap_does_not() -> None:
    world = flat_world(40, [WALL])
    assert not sight_is_clear(world, 0.0, 1.5, 0.0, 0.0, 1.5, 15.0)
    assert sight_is_clear(world, 0.0, 1.5, 0.0, 0.0, 1.5, 9.9)
    assert sight_is_clear(world, 3.0, 1.5, 0.0, 3.0, 1.5, 15.0)


@pytest.fixture(scope="module")
def country() -> World:
    return generate_map(MapConfig(size=60, houses=2, vegetation=0.8), 11).world


def by_brute_force(world: World, eye: np.ndarray, way: np.ndarray, far: float) -> float:
    """Return the distance to the nearest solid, or to the terrain by small steps and bisection."""
    nearest = far
    ray = make_ray(world, *eye, *way)
    for solid in range(len(world.solid_kind)):
        nearest = min(nearest, intersect_solid(world, solid, ray, nearest)[0])

    def above(t: float) -> float:
        x, y, z = eye + way * t
        return float(y - ground_at(world, x, z).height)

    last = 0.0
    for t in np.arange(0.0, far, 0.05):
        x, _, z = eye + way * t
        if max(abs(x), abs(z)) >= 30 or t > nearest:
            break
        if above(t) < 0:
            low, high = last, float(t)
            for _ in range(60):
                middle = (low + high) / 2
                low, high = (middle, high) if above(middle) >= 0 else (low, middle)
            return min(nearest, high)
        last = float(t)
    return nearest


@given(st.floats(-29, 29), st.floats(-29, 29), st.floats(0.3, 12), st.floats(0, 360), st.floats(-90, 90))
def test_the_grid_finds_what_brute_force_finds(
    country: World, x: float, z: float, up: float, yaw: float, pitch: float
) -> None:
    eye = np.array([x, ground_at(country, x, z).height + up, z])
    a, b = math.radians(yaw), math.radians(pitch)
    way = np.array([math.sin(a) * math.cos(b), -math.sin(b), math.cos(a) * math.cos(b)])
    hit = raycast(country, *eye, *way, 50.0)
    wanted = by_brute_force(country, eye, way, 50.0)
    assert min(hit.distance, 50.0) == pytest.approx(wanted, abs=1e-6)


@given(
    st.integers(-14, 14), st.integers(-14, 14), st.sampled_from([(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1)])
)
def test_rays_along_cell_edges_and_corners_find_the_ground(
    country: World, column: int, row: int, way: tuple[int, int]
) -> None:
    x, z = 2.0 * column, 2.0 * row
    dx, dz = way[0] * 0.6, way[1] * 0.6
    dy = -math.sqrt(1 - dx * dx - dz * dz)
    eye = np.array([x, 60.0, z])
    hit = raycast(country, *eye, dx, dy, dz, 200.0)
    wanted = by_brute_force(country, eye, np.array([dx, dy, dz]), 200.0)
    leaves_map = max(abs(x + dx * wanted), abs(z + dz * wanted)) >= 29.9
    assert leaves_map or hit.distance == pytest.approx(wanted, abs=1e-6)


def test_a_ray_that_starts_on_the_ground_can_leave_it() -> None:
    world = flat_world(40, slope=0.3)
    assert raycast(world, 1.0, 0.3 + 1e-9, 1.0, 0.0, 1.0, 0.0, 50.0).solid == NOTHING_HIT
    assert raycast(world, 1.0, 0.3 + 1e-9, 1.0, HALF, -HALF, 0.0, 50.0).solid == TERRAIN_HIT


def test_the_old_name_of_casting_a_ray_still_works() -> None:
    with pytest.warns(DeprecationWarning, match="cast_ray is called raycast now"):
        assert rays.cast_ray is raycast
