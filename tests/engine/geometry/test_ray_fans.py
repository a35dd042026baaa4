"""A fan of rays walks the grid once and finds what each of its rays finds alone."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.builders import box, flat_world

from wildscav_engine.geometry.ray_fans import RayFans, cast_ray_fan, meet_solid_with_ray_fan
from wildscav_engine.geometry.rays import cast_ray, make_ray
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import World
from wildscav_engine.maps import generate_map
from wildscav_engine.specs.map_spec import MapConfig

FAR = 40.0  # m over ground
SLOPES = np.array([1.0, 0.4, 0.1, 0.0, -0.1, -0.5, -2.0])


def cast(world: World, eye: tuple[float, float, float], yaw: float) -> np.ndarray:
    """Return how far over ground each ray of a fan goes."""
    fans = RayFans(SLOPES, np.full((1, len(SLOPES)), FAR), np.full(max(1, len(world.solid_kind)), -1))
    east, north = math.sin(math.radians(yaw)), math.cos(math.radians(yaw))
    cast_ray_fan(world, fans, 0, make_ray(world, *eye, east, 0.0, north))
    return np.asarray(fans.reach[0])


def cast_alone(world: World, eye: tuple[float, float, float], yaw: float) -> list[float]:
    """The same, ray by ray: a ray that rises by its slope for each metre over ground measures those."""
    east, north = math.sin(math.radians(yaw)), math.cos(math.radians(yaw))
    return [min(FAR, cast_ray(world, *eye, east, slope, north, FAR).distance) for slope in SLOPES.tolist()]


def test_rays_meet_a_wall_the_ground_or_nothing() -> None:
    # A wall 3 m high, 10 m north of an eye 1.5 m above ground.
    world = flat_world(40, [box((-2, 0, 10), (2, 3, 11))])

    reach = cast(world, (0.0, 1.5, 0.0), 0.0)

    # 1.5 + 10 and 1.5 + 4 pass above the wall; 1.5 - 0.1 × 10 meets it; -0.5 falls 1.5 m in 3 m.
    assert reach == pytest.approx([FAR, FAR, 10.0, 10.0, 10.0, 3.0, 0.75])


def test_only_rays_that_are_open_are_shortened() -> None:
    fans = RayFans(SLOPES, np.full((1, len(SLOPES)), FAR), np.zeros(1, np.int64))
    world = flat_world(40, [box((-2, 0, 10), (2, 3, 11))])
    solids = (world.solid_low, world.solid_high, world.solid_start, world.faces)
    ray = make_ray(world, 0.0, 1.5, 0.0, 0.0, 0.0, 1.0)

    meet_solid_with_ray_fan(solids, 0, fans, 0, ray, 3)

    # The rays after the fourth are left alone, though one of them meets the wall.
    assert fans.reach[0].tolist() == [FAR, FAR, 10.0, 10.0, FAR, FAR, FAR]


@pytest.fixture(scope="module")
def country() -> World:
    return generate_map(MapConfig(size=60, houses=2, vegetation=0.8), 11).world


@settings(max_examples=200)
@given(st.floats(-29, 29), st.floats(-29, 29), st.floats(0.3, 9), st.floats(0, 360))
def test_a_fan_finds_what_its_rays_find_to_the_last_bit(
    country: World, x: float, z: float, up: float, yaw: float
) -> None:
    eye = (x, ground_at(country, x, z).height + up, z)

    assert cast(country, eye, yaw).tolist() == cast_alone(country, eye, yaw)
