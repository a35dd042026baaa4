"""Barriers: the engine's own body passes each way through them, and nowhere else."""

import functools

import pytest
from tests.engine.maps.walk.walker import Walker

from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.maps.country import plan_country
from wildscav_engine.maps.country.wards import Barrier, Border
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.generate import generate_map
from wildscav_engine.maps.ground.terrain import make_terrain
from wildscav_engine.specs.map_spec import Country, MapConfig

KINDS = {
    "walls": Barrier.WALL,
    "thickets": Barrier.THICKET,
    "canyons": Barrier.RIDGE,
    "terraces": Barrier.CLIFF,
    "towns": Barrier.TOWN_WALL,
}
SEED = 5


@functools.cache
def country_of(kind: str) -> tuple[GameMap, tuple[Border, ...], tuple[float, ...]]:
    """A map with one kind of barriers, its borders, and the level of each ward."""
    weights = dict.fromkeys(KINDS, 0.0) | ({"walls": 1.0, "towns": 1} if kind == "towns" else {kind: 1.0})
    config = MapConfig(
        size=140 if kind == "towns" else 100,
        relief=0.2,
        water=0.0,
        houses=0,
        vegetation=0.0,
        country=Country(loops=0.1 if kind == "towns" else 0.5, hidden_targets=False, **weights),
    )
    plan = plan_country(config, SEED, make_terrain(config, SEED))
    assert plan is not None
    return generate_map(config, SEED), plan.wards.borders, tuple(plan.wards.levels.tolist())


def crosses(game_map: GameMap, border: Border, along: float, reach: float, *, leftwards: bool) -> bool:
    """Whether a body can walk straight across a border at a point of it."""
    side = -1.0 if leftwards else 1.0
    (x, z), end = border.at(along, -side * reach), border.at(along, side * reach)
    walker = Walker(game_map.world, x, ground_at(game_map.world, x, z).height, z)
    return walker.walk_to(*end, 5.0)


@pytest.mark.parametrize("kind", KINDS)
def test_a_body_walks_through_every_gate(kind: str) -> None:
    game_map, borders, levels = country_of(kind)
    gates = [border for border in borders if border.gate is not None and border.barrier is KINDS[kind]]
    assert len(gates) >= 4
    for border in gates:
        rise = abs(levels[border.wards[0]] - levels[border.wards[1]])
        for leftwards in (False, True):
            assert crosses(game_map, border, border.gate or 0.0, 1.5 + rise, leftwards=leftwards), border


@pytest.mark.parametrize("kind", KINDS)
def test_a_body_walks_through_no_closed_border(kind: str) -> None:
    game_map, borders, levels = country_of(kind)
    closed = [border for border in borders if border.gate is None and border.barrier is KINDS[kind]]
    assert len(closed) >= 2
    for border in closed:
        upwards = levels[border.wards[0]] > levels[border.wards[1]]
        for share in (0.3, 0.5, 0.7):
            along = share * border.length
            assert not crosses(game_map, border, along, 3.5, leftwards=upwards), (border, share)
