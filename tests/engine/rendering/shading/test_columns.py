"""What is prepared about a direction answers exactly what a ray along it does."""

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.builders import box, flat_world

from wildscav_engine.geometry.rays import NOTHING_HIT, raycast
from wildscav_engine.geometry.world import CELL, Kind, World, build_world
from wildscav_engine.maps import generate_map
from wildscav_engine.rendering.shading.appearance import UP
from wildscav_engine.rendering.shading.light.columns import (
    BLOCKED,
    CLEAR,
    MAX_COLUMNS,
    PER_SIDE,
    SIDE,
    STEEP,
    UNKNOWN,
    ShadowColumns,
    columns_of,
    is_blocked,
    write_columns,
)
from wildscav_engine.rendering.shading.light.sunlight import SHADOW_REACH, sun_is_clear, sun_shines
from wildscav_engine.rendering.shading.pixel_rows import Places
from wildscav_engine.rendering.shading.sky import SUN_DIRECTION
from wildscav_engine.specs.map_spec import MapConfig

LIFT = 0.004  # m


def to_sun(world: World) -> ShadowColumns:
    return columns_of(world, SUN_DIRECTION, np.ones(len(world.solid_kind), np.bool_), steep=True)


def is_sunny(columns: ShadowColumns, world: World, place: tuple[float, float, float]) -> bool:
    rows, numbers = np.empty((2, 1), np.int32)
    write_columns(columns, Places(*np.array(place, np.float32)[:, None]), rows, numbers)
    return sun_shines(columns, world, rows[0], numbers[0], place)


def surfaces(world: World, count: int) -> NDArray[np.float64]:
    """Return (N, 3) places slightly off whatever rays in all directions meet in a world."""
    random = np.random.default_rng(0)
    size = CELL * world.water.shape[1]
    low, high = (
        (world.corner[0], world.heights.max() - 4.0),
        (world.corner[0] + size, world.heights.max() + 9.0),
    )
    found = []
    for _ in range(count):
        eye = random.uniform((low[0], low[1], low[0]), (high[0], high[1], high[0]))
        way = random.normal(size=3)
        way /= np.linalg.norm(way)
        hit = raycast(world, *eye, *way, 100.0)
        if hit.solid != NOTHING_HIT and hit.distance > 2 * LIFT:
            found.append(eye + way * (hit.distance - LIFT))
    return np.array(found)


@pytest.mark.parametrize(
    "config",
    [
        pytest.param(MapConfig(size=60, houses=3, storeys=(1, 3), vegetation=0.9), id="houses and trees"),
        pytest.param(MapConfig(size=60, houses=1, relief=2.0, ruggedness=1.0), id="mountains"),
    ],
)
def test_the_sun_shines_on_the_same_surfaces_as_by_rays(config: MapConfig) -> None:
    world = generate_map(config, 5).world
    columns, places = to_sun(world), surfaces(world, 4000)
    shines = np.array([is_sunny(columns, world, tuple(place)) for place in places])
    free = [raycast(world, *place, *SUN_DIRECTION, SHADOW_REACH).solid == NOTHING_HIT for place in places]
    assert (shines == free).all()
    assert len(places) > 1000
    assert 0.2 < shines.mean() < 0.9


def test_the_sun_shines_where_a_ray_to_it_meets_nothing() -> None:
    world = generate_map(MapConfig(size=60, houses=2), 3).world
    low, high = (-32.0, world.heights.min() - 1.0, -32.0), (32.0, 12.0, 32.0)
    places = np.random.default_rng(0).uniform(low, high, (3000, 3))
    clear = [sun_is_clear(world, tuple(place)) for place in places]
    assert clear == [raycast(world, *at, *SUN_DIRECTION, SHADOW_REACH).solid == NOTHING_HIT for at in places]
    assert 500 < sum(clear) < 2500


def test_floors_and_roofs_are_above_the_same_places_as_by_rays() -> None:
    world = generate_map(MapConfig(size=60, houses=4, storeys=(2, 3)), 5).world
    overhead = np.isin(world.solid_kind, (Kind.FLOOR, Kind.ROOF))
    upwards = columns_of(world, UP, overhead, steep=False)
    size = CELL * world.water.shape[1]
    places = np.random.default_rng(1).uniform(0.0, 1.0, (3000, 3)) * (size, 14.0, size)
    places += (world.corner[0], world.heights.min(), world.corner[1])
    roofed = np.array([is_blocked(upwards, world, tuple(place)) == BLOCKED for place in places])
    wanted = [any(_is_over(world, solid, place) for solid in np.nonzero(overhead)[0]) for place in places]
    assert (roofed == wanted).all()
    assert 0.02 < roofed.mean() < 0.9


def _is_over(world: World, solid: int, place: NDArray[np.float64]) -> bool:
    """Return whether a solid contains a place or anything straight above it."""
    faces = world.faces[world.solid_start[solid] : world.solid_start[solid + 1]]
    rise, rest = faces[:, 1], faces[:, 3] - faces[:, :3] @ place
    level = np.abs(rise) < 1e-12
    if (rest[level] < 0.0).any():
        return False
    leave = (rest[rise > 1e-12] / rise[rise > 1e-12]).min()
    enter = max(0.0, (rest[rise < -1e-12] / rise[rise < -1e-12]).max())
    return bool(enter <= leave)


def test_a_closed_column_needs_no_solid_and_a_clear_one_neither() -> None:
    world = flat_world(40, [box((-5, 3, -5), (5, 4, 5), Kind.ROOF)])
    upwards = columns_of(world, UP, np.ones(1, np.bool_), steep=False)
    _, _, west, south, per_side = upwards.grid
    middle = upwards.record[int(-south * per_side), int(-west * per_side)]
    assert upwards.closed[middle] == pytest.approx(4.0, abs=0.01)
    assert upwards.clear[middle] == pytest.approx(4.0, abs=0.01)
    assert [is_blocked(upwards, world, (0.0, y, 0.0)) for y in (0.0, 3.5, 4.1)] == [BLOCKED, BLOCKED, CLEAR]
    assert is_blocked(upwards, world, (5.4, 0.0, 0.0)) == CLEAR
    assert is_blocked(upwards, world, (1e9, 0.0, -1e9)) == CLEAR


def test_only_ground_that_faces_away_from_the_sun_is_left_to_rays() -> None:
    gentle = flat_world(40, slope=0.5)
    assert STEEP not in to_sun(gentle).solids
    heights = np.tile(np.where(np.arange(21) < 10, 12.0, 0.0), (21, 1))  # falls eastwards, away from the sun
    cliff = build_world((-20.0, -20.0), heights, np.full((20, 20), -np.inf), [], gentle.spawns)
    columns = to_sun(cliff)
    assert STEEP in columns.solids
    assert is_blocked(columns, cliff, (1.0, 0.01, 0.0)) == UNKNOWN
    assert not is_sunny(columns, cliff, (1.0, 0.01, 0.0))
    assert is_sunny(columns, cliff, (-15.0, 12.01, 0.0))


def test_a_large_map_has_wider_columns_instead_of_more() -> None:
    assert to_sun(flat_world(40)).grid[PER_SIDE] == 1.0 / SIDE
    large = to_sun(flat_world(2000))
    assert large.record.size <= 1.01 * MAX_COLUMNS
    assert large.grid[PER_SIDE] < 1.0 / SIDE
