"""Trees, bushes and rocks: their number and places, and how they affect bodies, shots and sight."""

from collections import Counter
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.builders import flat_world
from tests.engine.maps.walk.walker import Walker

from wildscav_engine.geometry.rays import raycast
from wildscav_engine.geometry.segments import nearest_on
from wildscav_engine.geometry.shapes import allocate_ring_stacks, solids_of
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import Kind, Solid, World, build_world
from wildscav_engine.maps.ground.terrain import (
    Terrain,
    distance_to_footprint,
    level_ground,
    make_terrain,
    water_of_cells,
)
from wildscav_engine.maps.house import doorsteps, draw_plan
from wildscav_engine.maps.settlements.sites import Settlement, footprints_of, settle
from wildscav_engine.maps.vegetation.planting import plant
from wildscav_engine.maps.vegetation.species import (
    BLOCK,
    BOULDER,
    BROADLEAF,
    BUSH,
    COLUMNS,
    CONIFER,
    HEIGHT,
    KEY,
    PARTS,
    POPLAR,
    RADIUS,
    SPECIES,
    STEPPING_STONE,
    draw_size,
    grow,
)
from wildscav_engine.specs.map_spec import MapConfig

GROWN = (Kind.TRUNK, Kind.BUSH, Kind.ROCK)  # what stands on the ground


class Country(NamedTuple):
    """A planted map."""

    world: World
    settlement: Settlement
    steps: NDArray[np.float64]
    solids: list[Solid]


@lru_cache(maxsize=4)
def country(seed: int, config: MapConfig) -> Country:
    terrain = make_terrain(config, seed)
    plans = [draw_plan(seed, number, config.storeys) for number in range(config.houses)]
    settlement = settle(config, seed, terrain, [plan.size for plan in plans])
    sites = settlement.sites
    level_ground(
        terrain.corner, footprints_of(sites), np.array([site.ground for site in sites]), terrain.heights
    )
    steps = [step for plan, site in zip(plans, sites, strict=False) for step in doorsteps(plan, site, 1.5)]
    steps_array = np.array(steps, np.float64).reshape(-1, 2)
    solids = plant(config, seed, terrain, sites, steps_array, settlement.lanes)
    water = water_of_cells(terrain.heights, terrain.water_level)
    world = build_world(terrain.corner, terrain.heights, water, solids, np.zeros((1, 3)))
    return Country(world, settlement, steps_array, solids)


VILLAGE = MapConfig(size=160, houses=10, density="high", water=0.2, vegetation=1.0)
WOODS = MapConfig(size=300, houses=0, vegetation=0.6)


def circles(solids: list[Solid], *kinds: Kind) -> NDArray[np.float64]:
    """(N, 3) m: x and z of the middle of each solid of some kinds, and the radius around it."""
    rows = []
    for solid in solids:
        if solid.kind in kinds:
            middle, half = (solid.low + solid.high) / 2, (solid.high - solid.low) / 2
            rows.append((middle[0], middle[2], max(half[0], half[2])))
    return np.array(rows).reshape(-1, 3)


def one_of(species: int, key: int = 1, seed: int = 0) -> tuple[list[Solid], NDArray[np.float64]]:
    """A single plant in the middle of level ground, and its row."""
    rows = np.zeros((1, COLUMNS))
    rows[0, SPECIES], rows[0, KEY] = species, key
    draw_size(np.uint64(seed), rows[0])
    stacks = allocate_ring_stacks(PARTS)
    return solids_of(stacks, grow(rows, 1, stacks)), rows[0]


def test_how_many_plants_there_are() -> None:
    counts = Counter(solid.kind for solid in country(0, MapConfig(size=500, houses=0, vegetation=1)).solids)

    assert 1800 <= counts[Kind.TRUNK] <= 1875
    assert 700 <= counts[Kind.ROCK] <= 750
    assert 900 <= counts[Kind.BUSH] <= 1000
    assert counts[Kind.CROWN] > 0.9 * counts[Kind.TRUNK]  # some are dead, some conifers have two


def test_a_bare_map_has_no_plants() -> None:
    assert country(0, MapConfig(size=60, houses=1, vegetation=0)).solids == []


def test_the_same_seed_grows_the_same_plants_and_another_seed_others() -> None:
    config = MapConfig(size=80, houses=0)
    first, again, other = (
        plant(config, seed, make_terrain(config, 0), [], np.zeros((0, 2))) for seed in (3, 3, 4)
    )

    assert [solid.planes.tobytes() for solid in first] == [solid.planes.tobytes() for solid in again]
    assert [solid.planes.tobytes() for solid in first] != [solid.planes.tobytes() for solid in other]


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_plants_keep_out_of_houses_doorways_lanes_and_lakes(seed: int) -> None:
    world, (sites, lanes), steps, solids = country(seed, VILLAGE)

    assert len(lanes) > 5
    assert len(circles(solids, *GROWN)) > 200
    for x, z, radius in circles(solids, *GROWN):
        assert all(distance_to_footprint(row, x, z) > radius + 1.5 for row in footprints_of(sites))
        assert np.hypot(*(steps - (x, z)).T).min() > radius + 2.8
        nearest = np.array([nearest_on(lane, x, z) for lane in lanes])
        assert np.hypot(*(nearest - (x, z)).T).min() > radius + 2.8
        assert ground_at(world, x, z).height > 0
    for x, z, radius in circles(solids, Kind.CROWN):
        assert all(distance_to_footprint(row, x, z) > radius + 0.5 for row in footprints_of(sites))


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_one_walks_between_any_two_things_that_do_not_touch(seed: int) -> None:
    rows = circles(country(seed, VILLAGE).solids, *GROWN)
    apart = np.hypot(*(rows[:, None, :2] - rows[None, :, :2]).transpose(2, 0, 1))
    gaps = apart - rows[:, None, 2] - rows[None, :, 2]

    # A circle is slightly wider than its contents, so members of one cluster have gaps well below 0.5 m.
    group = np.arange(len(rows))
    for one, other in np.argwhere(np.triu(gaps < 0.3, 1)):
        group[group == group[other]] = group[one]
    between = gaps[group[:, None] != group[None, :]]
    assert between.min() > 1.4


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_one_walks_under_crowns(seed: int) -> None:
    world, _, _, solids = country(seed, VILLAGE)

    for solid in solids:
        if solid.kind == Kind.CROWN:
            for x in np.linspace(solid.low[0], solid.high[0], 5).clip(-80, 80):
                for z in np.linspace(solid.low[2], solid.high[2], 5).clip(-80, 80):
                    assert solid.low[1] - ground_at(world, x, z).height >= 2.4 - 1e-9


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_trees_stand_in_woods_with_meadows_between(seed: int) -> None:
    trees = circles(country(seed, WOODS).solids, Kind.TRUNK)
    counts = np.histogram2d(trees[:, 0], trees[:, 1], bins=15, range=[(-150, 150)] * 2)[0]

    assert counts.var() > 2 * counts.mean()  # with uniform scattering, the two would be equal
    assert (counts == 0).mean() > 0.3


def test_rocks_lie_where_it_is_steep() -> None:
    across = np.arange(151) * 2.0 - 150
    heights = np.tile(np.where(across > 0, across * 0.6, 0.0), (151, 1))
    config = MapConfig(size=300, houses=0, vegetation=0.5)
    solids = plant(config, 0, Terrain((-150.0, -150.0), heights, -np.inf), [], np.zeros((0, 2)))
    rocks = circles(solids, Kind.ROCK)

    assert (rocks[:, 0] > 0).sum() > 2 * (rocks[:, 0] < 0).sum()


def test_all_species_and_groups_are_met() -> None:
    solids = country(1, WOODS).solids
    bushes = circles(solids, Kind.BUSH)
    apart = np.hypot(*(bushes[:, None, :2] - bushes[None, :, :2]).transpose(2, 0, 1))
    slender = [solid.high[1] - solid.low[1] > 3 * (solid.high[0] - solid.low[0]) for solid in solids]

    assert (apart < 1.3).sum(axis=1).max() >= 3  # itself and both neighbours in a hedge
    assert any(slender)


@pytest.mark.parametrize("species", range(8))
@given(key=st.integers(0, 2**20))
@settings(max_examples=30)
def test_shapes_are_convex_and_reach_from_the_ground_to_their_height(species: int, key: int) -> None:
    solids, row = one_of(species, key)

    assert solids[0].low[1] < 0
    top = max(solid.high[1] for solid in solids)
    assert top >= row[HEIGHT] - 1e-9
    for solid in solids:
        # Each face's plane touches the box, and the middle of the box is inside.
        middle = (solid.low + solid.high) / 2
        assert (solid.planes[:, :3] @ middle < solid.planes[:, 3]).all()
        assert np.allclose(np.hypot(np.hypot(*solid.planes[:, :2].T), solid.planes[:, 2]), 1)
        for x in (0.0, 1.0):
            corner = solid.low * (1 - x) + solid.high * x
            assert (corner[[0, 2]] * (2 * x - 1) > 0).all()


@pytest.mark.parametrize("species", [STEPPING_STONE, BLOCK, BOULDER])
@given(key=st.integers(0, 2**20))
def test_rocks_have_a_level_top_a_metre_across(species: int, key: int) -> None:
    solids, row = one_of(species, key)
    planes, height = solids[0].planes, solids[0].high[1]
    sides = planes[np.abs(planes[:, 1]) < 0.99]
    x = (solids[0].low[0] + solids[0].high[0]) / 2
    z = (solids[0].low[2] + solids[0].high[2]) / 2

    # How far the middle of the top is from each side's edge, along the top.
    away = (sides[:, 3] - sides[:, :3] @ (0 * x, height, 0 * z)) / np.hypot(sides[:, 0], sides[:, 2])
    assert away.min() > 0.5
    limits = {STEPPING_STONE: (0.3, 0.5), BLOCK: (0.7, 1.1), BOULDER: (1.5, 3.0)}[species]
    assert limits[0] <= row[HEIGHT] <= limits[1]


def walk_at(species: int, *, jump: bool) -> float:
    """Return the height in m of a body after walking (and jumping) against a rock and stopping on its top."""
    solids, row = one_of(species, 7)
    walker = Walker(flat_world(solids=solids), 0.0, 0.0, -row[RADIUS] - 0.8)
    for _ in range(200):
        speed = 3.0 if walker.position[0, 2] < -0.3 else 0.0
        walker.move(0.0, speed, jump and speed > 0)
    return float(walker.position[0, 1])


def test_one_steps_onto_low_rocks_jumps_onto_higher_ones_and_is_stopped_by_boulders() -> None:
    heights = {species: one_of(species, 7)[1][HEIGHT] for species in (STEPPING_STONE, BLOCK)}

    assert walk_at(STEPPING_STONE, jump=False) == pytest.approx(heights[STEPPING_STONE], abs=0.02)
    assert walk_at(BLOCK, jump=False) == pytest.approx(0)
    assert walk_at(BLOCK, jump=True) == pytest.approx(heights[BLOCK], abs=0.02)
    assert walk_at(BOULDER, jump=True) == pytest.approx(0)


def test_a_bush_stops_a_ray_and_one_above_it_passes() -> None:
    solids, row = one_of(BUSH, 3)
    world = flat_world(solids=solids)

    hit = raycast(world, -10, 0.4 * row[HEIGHT], 0, 1, 0, 0, 20)
    assert hit.solid == 0
    assert 10 - row[RADIUS] - 0.01 <= hit.distance < 10
    assert raycast(world, -10, row[HEIGHT] + 0.05, 0, 1, 0, 0, 20).distance == np.inf


@pytest.mark.parametrize("species", [BROADLEAF, CONIFER, POPLAR])
def test_a_crown_stops_a_ray_at_its_shape_and_lets_pass_what_goes_beside(species: int) -> None:
    solids, _ = one_of(species, 5)
    world = flat_world(solids=solids)
    crowns = [number for number, solid in enumerate(solids) if solid.kind == Kind.CROWN]
    low, high = solids[crowns[0]].low, solids[crowns[0]].high
    widest = low[1] + (0.1 if species == CONIFER else 0.3) * (high[1] - low[1])
    half_width = (high[0] - low[0]) / 2

    through = raycast(world, -15, widest, 0.3, 1, 0, 0, 30)
    assert through.solid in crowns
    assert 15 - half_width <= through.distance <= 15 - 0.6 * half_width
    assert raycast(world, -15, widest, high[2] + 0.05, 1, 0, 0, 30).distance == np.inf
    # The corner of the box around a crown is not part of it.
    assert raycast(world, -15, high[1] - 0.05, 0.9 * half_width, 1, 0, 0, 30).distance == np.inf
