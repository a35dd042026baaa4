"""Trees and rocks: how many, and where not."""

import numpy as np
import pytest
from numpy.typing import NDArray

from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import Kind, World
from wildscav_engine.maps import generate_map
from wildscav_engine.maps.generate import plans_and_sites
from wildscav_engine.maps.house import doorsteps
from wildscav_engine.maps.sites import footprints_of
from wildscav_engine.maps.terrain import distance_to_footprint
from wildscav_engine.spec import MapConfig

WOODS = MapConfig(size=80, houses=4, water=0.2, vegetation=1.0)


def places_of(world: World, kind: Kind) -> NDArray[np.float64]:
    """Return (N, 2) m, x and z of the middle of each solid of a kind."""
    chosen = world.solid_kind == kind
    return ((world.solid_low + world.solid_high) / 2.0)[chosen][:, [0, 2]]


def test_how_many_plants_there_are() -> None:
    world = generate_map(MapConfig(size=100, houses=2, vegetation=0.4), 0).world

    assert 25 <= len(places_of(world, Kind.TRUNK)) <= 30
    assert 9 <= len(places_of(world, Kind.ROCK)) <= 12
    assert len(places_of(world, Kind.CROWN)) == len(places_of(world, Kind.TRUNK))


def test_a_bare_map_has_no_plants() -> None:
    kinds = generate_map(MapConfig(size=60, houses=1, vegetation=0.0), 0).world.solid_kind

    assert not np.isin(kinds, [Kind.TRUNK, Kind.CROWN, Kind.ROCK]).any()


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_plants_keep_out_of_houses_doorways_and_lakes(seed: int) -> None:
    world = generate_map(WOODS, seed).world
    plans, sites = plans_and_sites(WOODS, seed)
    steps = [step for plan, site in zip(plans, sites, strict=True) for step in doorsteps(plan, site, 1.5)]
    plants = np.concatenate([places_of(world, Kind.TRUNK), places_of(world, Kind.ROCK)])

    assert len(plants) > 30
    for x, z in plants:
        assert all(distance_to_footprint(footprint, x, z) > 2.5 for footprint in footprints_of(sites))
        assert all(np.hypot(x - step[0], z - step[1]) > 3.0 for step in steps)
        assert ground_at(world, x, z).height > 0.0


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_one_walks_under_crowns_and_between_trunks(seed: int) -> None:
    world = generate_map(WOODS, seed).world

    for solid in np.flatnonzero(world.solid_kind == Kind.CROWN):
        low, high = world.solid_low[solid], world.solid_high[solid]
        for x in np.linspace(low[0], high[0], 5):
            for z in np.linspace(low[2], high[2], 5):
                assert low[1] - ground_at(world, x, z).height >= 2.3
    trunks = places_of(world, Kind.TRUNK)
    for number, (x, z) in enumerate(trunks):
        others = np.delete(trunks, number, axis=0)
        assert np.hypot(others[:, 0] - x, others[:, 1] - z).min() > 2.9
