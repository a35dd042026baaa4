"""Viewpoints on maps."""

import numpy as np
import pytest
from tests.builders import box, flat_world, map_from

from wildscav_engine.geometry.rays import raycast
from wildscav_engine.geometry.world import Kind
from wildscav_engine.maps import generate_map
from wildscav_engine.maps.viewpoints import standing_height, viewpoint_of
from wildscav_engine.sensors import SegmentationCamera
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.specs.map_spec import MapConfig

FLOOR = box((-3, 0, -3), (3, 0.2, 3), Kind.FLOOR)
UPPER = box((-3, 3, -3), (3, 3.2, 3), Kind.FLOOR)
WALL = box((-3, 0, 3), (3, 3, 3.3))
CHEST = box((1, 0.2, 1), (2, 1.0, 2), Kind.FURNITURE)


@pytest.mark.parametrize(
    ("place", "height"),
    [
        ((8, 8), 0.0),  # on the ground
        ((0, 0), 0.2),  # in a house, on its lowest floor and not on the upper one
        ((1.5, 1.5), 1.0),  # on top of what stands there
        ((0, 3.1), 3.0),  # on top of a wall
        ((3.5, 0), 0.0),  # beside it
    ],
)
def test_one_stands_at_the_lowest_place_with_room_for_a_body(
    place: tuple[float, float], height: float
) -> None:
    world = flat_world(solids=[FLOOR, UPPER, WALL, CHEST])
    assert standing_height(world, *place) == pytest.approx(height)


def test_a_ceiling_that_is_too_low_is_stood_on() -> None:
    world = flat_world(solids=[box((-3, 1.7, -3), (3, 2, 3))])
    assert standing_height(world, 0, 0) == 2.0
    world = flat_world(solids=[box((-3, 1.8, -3), (3, 2, 3))])
    assert standing_height(world, 0, 0) == 0.0


def test_on_a_lake_one_stands_at_its_surface() -> None:
    assert standing_height(flat_world(water=1.5), 3.0, 4.0) == 1.5
    assert standing_height(flat_world(water=-1.5), 3.0, 4.0) == 0.0


def test_on_a_slope_one_stands_where_the_ground_is() -> None:
    assert standing_height(flat_world(slope=0.5), 7.0, 4.0) == pytest.approx(3.5)


@pytest.mark.parametrize("seed", range(6))
def test_every_location_is_a_place_to_stand_and_look_from(seed: int) -> None:
    game_map = generate_map(MapConfig(size=80, houses=3, storeys=(1, 3), water=0.1), seed)
    for x, y, z in game_map.outdoor[::20]:
        assert standing_height(game_map.world, x, z) <= y + 1e-6
    view = viewpoint_of(game_map)
    assert abs(view.pitch) < 45
    feet = np.array(view.eye) - [0, EYE_HEIGHT, 0]
    assert np.abs(game_map.outdoor - feet).sum(axis=1).min() < 1e-9  # a body may stand there
    assert feet[1] == pytest.approx(standing_height(game_map.world, feet[0], feet[2]))  # and on no roof
    (labels,) = SegmentationCamera(64, 36, 100.0, 75.0).render(game_map, [view.eye], [view.yaw], [view.pitch])
    of_house = np.isin(labels, (Kind.WALL, Kind.ROOF, Kind.FLOOR, Kind.STAIR, Kind.FURNITURE))
    assert of_house.mean() > 0.08
    assert of_house[18, 32]  # in the middle


def test_a_map_without_houses_can_be_looked_at_too() -> None:
    game_map = map_from(flat_world(slope=0.1))
    view = viewpoint_of(game_map)
    x, y, z = view.eye
    assert y == pytest.approx(standing_height(game_map.world, x, z) + EYE_HEIGHT)
    assert raycast(game_map.world, x, y, z, 0.0, 1.0, 0.0, 1.0).distance > 0
