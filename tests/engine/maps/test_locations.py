"""Standing places, outdoors and indoors."""

import numpy as np
import pytest

from wildscav_engine.body import BODY_HEIGHT, BODY_RADIUS
from wildscav_engine.geometry.shapes import box, pose
from wildscav_engine.geometry.terrain import ground_at, water_at
from wildscav_engine.geometry.world import Kind, Solid, World, build_world
from wildscav_engine.maps import GameMap, generate_map
from wildscav_engine.maps.locations import is_clear, outdoor_places, reachable_ground
from wildscav_engine.spec import MapConfig

CONFIG = MapConfig(size=80, houses=4, storeys=(1, 3), water=0.2, vegetation=1.0)
NORTH = pose(0.0, 0.0, 0.0)


@pytest.fixture(scope="module", params=[0, 1])
def game_map(request: pytest.FixtureRequest) -> GameMap:
    return generate_map(CONFIG, request.param)


def flat_world(*solids: Solid, heights: np.ndarray | None = None, water: np.ndarray | None = None) -> World:
    """A world of 40 × 40 m."""
    heights = np.zeros((21, 21)) if heights is None else heights
    water = np.full((20, 20), -np.inf) if water is None else water
    return build_world((-20.0, -20.0), heights, water, list(solids), np.zeros((0, 3)))


def test_there_is_about_one_outdoor_place_in_16_square_metres(game_map: GameMap) -> None:
    assert 0.55 * 80 * 80 / 16 < len(game_map.outdoor) <= 80 * 80 / 16


def test_outdoor_places_are_dry_gentle_ground_inside_the_map(game_map: GameMap) -> None:
    for x, y, z in game_map.outdoor:
        ground = ground_at(game_map.world, x, z)
        assert y == ground.height
        assert np.hypot(ground.slope_x, ground.slope_z) < 0.7003  # 35°
        assert np.isneginf(water_at(game_map.world, x, z))
        assert max(abs(x), abs(z)) < 39.5


def test_no_place_is_in_a_solid(game_map: GameMap) -> None:
    world = game_map.world
    for x, y, z in np.concatenate([game_map.outdoor, game_map.indoor]):
        near = np.all((world.solid_low <= (x + 1.0, y + 3.0, z + 1.0)), axis=1)
        near &= np.all((world.solid_high >= (x - 1.0, y - 1.0, z - 1.0)), axis=1)
        for solid in np.flatnonzero(near):
            n_x, n_y, n_z, offset = world.faces[world.solid_start[solid] : world.solid_start[solid + 1]].T
            away = n_x * x + n_y * y + n_z * z - offset
            away -= BODY_RADIUS * np.hypot(n_x, n_z) + BODY_HEIGHT * np.maximum(0.0, -n_y)
            low, high = world.solid_low[solid], world.solid_high[solid]
            beside = max(low[0] - x, x - high[0], low[2] - z, z - high[2]) - BODY_RADIUS
            assert max(away.max(), beside, low[1] - BODY_HEIGHT - y, y - high[1]) >= -1e-9


def test_every_storey_has_indoor_places(game_map: GameMap) -> None:
    for house in game_map.houses:
        near = np.hypot(
            game_map.indoor[:, 0] - house.center[0], game_map.indoor[:, 2] - house.center[1]
        ) < max(house.size)
        for storey in range(house.storeys):
            floor = house.ground + storey * house.storey_height
            on_floor = near & (np.abs(game_map.indoor[:, 1] - floor) < 1e-9)
            assert on_floor.sum() >= house.size[0] * house.size[1] / 12.0


@pytest.mark.parametrize(
    ("x", "y", "clear"),
    [
        (0.0, 0.0, False),  # in the middle of the wall
        (0.7, 0.0, False),  # its side is 0.5 m + 0.45 m of body away
        (1.01, 0.0, True),
        (0.0, 2.0, True),  # standing on top
        (0.0, -1.9, True),  # under it
        (0.0, -1.7, False),
    ],
)
def test_a_body_is_clear_of_a_wall(x: float, y: float, clear: bool) -> None:
    world = flat_world(box(Kind.WALL, NORTH, (-0.5, 0.0, -5.0), (0.5, 2.0, 5.0)))

    assert is_clear(world, x, y, 0.0) is clear


def test_a_walled_off_part_is_not_reachable() -> None:
    # A wall from edge to edge: 16 m of the map lie west of it, 23 m east.
    world = flat_world(box(Kind.WALL, NORTH, (-4.0, -1.0, -30.0), (-3.0, 3.0, 30.0)))

    reachable = reachable_ground(world)

    assert not reachable[:, : 20 - 3].any()
    assert reachable[1:-1, 20:-1].all()
    assert outdoor_places(world, reachable, np.uint64(1))[:, 0].min() > -3.0


def test_a_gap_as_wide_as_a_doorway_is_a_way() -> None:
    walls = [
        box(Kind.WALL, NORTH, (-4.0, -1.0, -30.0), (-3.0, 3.0, -0.65)),
        box(Kind.WALL, NORTH, (-4.0, -1.0, 0.65), (-3.0, 3.0, 30.0)),
    ]

    assert reachable_ground(flat_world(*walls))[1:-1, 1:15].all()


def test_ground_too_steep_is_no_way_and_water_is_one() -> None:
    heights = np.zeros((21, 21))
    heights[:, :10] = 3.0  # a cliff of 56° between columns 9 and 10
    heights[:, 14:17] = -1.0
    water = np.full((20, 20), -np.inf)
    water[:, 13:17] = 0.0

    reachable = reachable_ground(flat_world(heights=heights, water=water))

    assert not reachable[:, : 2 * 9].any()
    assert reachable[1:-1, 2 * 10 + 1 : -1].all()
