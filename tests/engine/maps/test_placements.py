"""Placements: where they stand, and which are refused."""

import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.engine.maps.by_hand import level_ground, middle_of

from wildscav_engine.geometry.world import Kind
from wildscav_engine.maps.errors import MapError
from wildscav_engine.maps.ground.terrain import distance_to_footprint
from wildscav_engine.maps.placements import fixed_houses, placed_solids
from wildscav_engine.maps.settlements.footprints import footprints_of
from wildscav_engine.maps.vegetation.planting import plant
from wildscav_engine.specs.map_spec import MapConfig


def config_of(*placements: dict[str, Any], **fields: Any) -> MapConfig:
    return MapConfig.model_validate({"size": 100, "houses": 0, "placements": placements, **fields})


def test_a_house_stands_where_it_is_placed_with_its_area_orientation_and_storeys() -> None:
    house = {"kind": "house", "location": (10, -20), "area": (14, 11), "orientation": 30, "storeys": 3}
    (plan,), (site,) = fixed_houses(config_of(house), 0, level_ground(100, slope=0.1))

    assert (site.pose.x, site.pose.z, site.yaw) == (10, -20, 30)
    assert plan.size == site.size == (14, 11)
    assert len(plan.storeys) == 3
    assert site.ground == pytest.approx(1.0, abs=0.2)  # the natural ground's mean


def test_a_house_without_area_is_as_the_generator_draws_one() -> None:
    house = {"kind": "house", "location": (0, 0)}
    sizes = {
        fixed_houses(config_of(house, storeys=(2, 2)), seed, level_ground(100))[0][0].size
        for seed in range(5)
    }
    plans, _ = fixed_houses(config_of(house, storeys=(2, 2)), 0, level_ground(100))

    assert len(sizes) == 5
    assert len(plans[0].storeys) == 2


def test_houses_side_by_side_share_one_level() -> None:
    houses = [{"kind": "house", "location": (x, 0), "area": (10, 10)} for x in (-6, 6)]
    _, sites = fixed_houses(config_of(*houses), 0, level_ground(100, slope=0.1))

    assert sites[0].ground == sites[1].ground


def test_a_block_stands_on_the_ground_turned_and_as_high_as_asked() -> None:
    block = {"kind": "block", "location": (20, 0), "area": (8, 2), "orientation": 90, "height": 3}
    (solid,) = placed_solids(config_of(block), 0, level_ground(100, slope=0.2))

    assert solid.kind == Kind.WALL
    assert solid.high == pytest.approx([21, 4 + 3, 4])
    assert solid.low[[0, 2]] == pytest.approx([19, -4])
    assert solid.low[1] < 0.2 * 19  # into the lowest ground under it


@pytest.mark.parametrize(("kind", "of"), [("tree", Kind.TRUNK), ("bush", Kind.BUSH), ("rock", Kind.ROCK)])
def test_a_single_plant_stands_exactly_where_it_is_placed(kind: str, of: Kind) -> None:
    solids = placed_solids(config_of({"kind": kind, "location": (7, -9)}), 3, level_ground(100))

    chosen = [solid for solid in solids if solid.kind == of]
    assert len(chosen) == 1
    assert middle_of(chosen[0]) == pytest.approx([7, -9], abs=0.5)


@pytest.mark.parametrize(
    ("kind", "of", "least", "most"),
    [("tree", Kind.TRUNK, 10, 16), ("bush", Kind.BUSH, 20, 40), ("rock", Kind.ROCK, 8, 24)],
)
def test_an_area_is_filled_by_its_density_and_nothing_stands_beside_it(
    kind: str, of: Kind, least: int, most: int
) -> None:
    area = {"kind": kind, "location": (10, 10), "area": (40, 20), "orientation": 60}
    full = placed_solids(config_of({**area, "density": 0.5}), 0, level_ground(100))
    thin = placed_solids(config_of({**area, "density": 0.1}), 0, level_ground(100))
    row = np.array([10, 10, np.sqrt(0.75), 0.5, 20, 10])

    places = [middle_of(solid) for solid in full if solid.kind == of]
    assert least <= len(places) <= most
    assert all(distance_to_footprint(row, x, z) < 0.6 for x, z in places)
    assert 0 < sum(solid.kind == of for solid in thin) < len(places)


def test_an_area_leaves_water_houses_and_blocks_free() -> None:
    config = config_of(
        {"kind": "tree", "location": (0, 0), "area": (90, 90), "density": 1},
        {"kind": "house", "location": (20, 0), "area": (12, 10)},
        {"kind": "block", "location": (20, 30), "area": (6, 6)},
    )
    terrain = level_ground(100, slope=0.1, water_level=0.0)
    _, (site,) = fixed_houses(config, 0, terrain)
    trunks = [middle_of(solid) for solid in placed_solids(config, 0, terrain) if solid.kind == Kind.TRUNK]

    assert len(trunks) > 50
    assert all(x > 0 for x, _ in trunks)
    assert all(distance_to_footprint(np.array(site.footprint), x, z) > 4.5 for x, z in trunks)
    assert all(max(abs(x - 20), abs(z - 30)) > 4.5 for x, z in trunks)


def test_random_plants_keep_clear_of_what_is_placed() -> None:
    config = config_of(
        {"kind": "block", "location": (0, 0), "area": (30, 6), "orientation": 45},
        {"kind": "rock", "location": (-20, 20)},
        vegetation=1,
    )
    root = np.sqrt(0.5)
    for solid in plant(config, 0, level_ground(100), [], np.zeros((0, 2))):
        if solid.kind in (Kind.TRUNK, Kind.ROCK, Kind.BUSH):
            x, z = middle_of(solid)
            radius = max(solid.high[0] - solid.low[0], solid.high[2] - solid.low[2]) / 2
            assert distance_to_footprint(np.array([0, 0, root, root, 15, 3]), x, z) > radius + 1.4
            assert np.hypot(x + 20, z - 20) > radius + 2.2 + 1.4


HOUSE = {"kind": "house", "area": (10, 10)}
BLOCK = {"kind": "block", "location": (0, 0)}


@pytest.mark.parametrize(
    ("placements", "message"),
    [
        (
            [{**HOUSE, "location": (45, 0)}],
            "outside the map; with 10.0 × 10.0 m this way round x can be -42.00 to 42.00 and z -42.00 to",
        ),
        (
            [{**HOUSE, "location": (10, 0)}, {**HOUSE, "location": (15, 5)}],
            "placements.1: overlaps placements.0",
        ),
        (
            [{**HOUSE, "location": (10, 0)}, {**HOUSE, "location": (21, 0)}],
            "placements.1: is 1.00 m from placements.0",
        ),
        (
            [{**HOUSE, "location": (-30, 0)}],
            "placements.0.location is (-30.0, 0.0): the house would stand in water",
        ),
        ([{**HOUSE, "location": (0, 0), "area": (3, 10)}], "placements.0.area"),
        ([BLOCK], "placements.0.area: a block needs one"),
        ([{**BLOCK, "location": (49, 0), "area": (4, 4)}], "placements.0.location is (49.0, 0.0): outside"),
        ([{**BLOCK, "area": (150, 4)}], "placements.0.area: 150.0 × 4.0 m this way round do not fit"),
        (
            [{"kind": "tree", "location": (60, 0)}],
            "outside the map; x can be -49.50 to 49.50 and z -49.50 to 49.50",
        ),
        ([{"kind": "rock", "location": (-30, 0)}], "placements.0.location is (-30.0, 0.0): in water"),
        (
            [{"kind": "bush", "location": (45, 0), "area": (20, 5)}],
            "placements.0.location is (45.0, 0.0): outside",
        ),
        (
            [{"kind": "bush", "location": (22, 0)}, {**HOUSE, "location": (20, 0)}],
            "placements.0: stands in the house of placements.1",
        ),
    ],
)
def test_what_cannot_be_is_refused_by_name(placements: list[dict[str, Any]], message: str) -> None:
    config = config_of(*placements)
    terrain = level_ground(100, slope=0.1, water_level=-1.0)
    with pytest.raises(MapError, match=re.escape(message)):
        _ = fixed_houses(config, 0, terrain), placed_solids(config, 0, terrain)


@given(st.floats(-360, 360), st.floats(8, 18), st.floats(8, 18), st.sampled_from([-1, 1]))
def test_a_location_at_the_end_of_the_range_given_works(
    turn: float, across: float, along: float, side: int
) -> None:
    house = {"kind": "house", "area": (across, along), "orientation": turn}
    with pytest.raises(MapError) as refused:
        fixed_houses(config_of({**house, "location": (1000, 0)}), 0, level_ground(100))
    limits = [float(number) for number in re.findall(r"to (\d+\.\d+)", str(refused.value))]
    _, (site,) = fixed_houses(
        config_of({**house, "location": (side * limits[0], side * limits[1])}), 0, level_ground(100)
    )

    assert np.abs(footprints_of([site])[0, :2]).tolist() == limits
