"""Wards: all of them are joined, by as few ways as the config wants, and cover the whole map."""

import numpy as np
import pytest

from wildscav_engine.maps.country.landforms import ward_of_points
from wildscav_engine.maps.country.wards import Barrier, Block, Wards, draw_wards
from wildscav_engine.maps.ground.terrain import Terrain
from wildscav_engine.specs.map_spec import Country

TOWN = Block(1, 2, 2)


def wards_with(seed: int = 1, **fields: float) -> Wards:
    return draw_wards(200, Country(**fields), seed, [TOWN])


def joined(wards: Wards) -> set[int]:
    """The wards that ways lead to from ward 0."""
    reached, last = {0}, -1
    while last != len(reached):
        last = len(reached)
        for border in wards.borders:
            if border.gate is not None and not reached.isdisjoint(border.wards):
                reached |= set(border.wards)
    return reached


@pytest.mark.parametrize("seed", range(5))
def test_without_loops_there_is_exactly_one_way_between_two_wards(seed: int) -> None:
    wards = wards_with(seed, loops=0.0)
    everywhere = set(wards.numbers.reshape(-1).tolist())
    assert len(everywhere) == 64 - 3  # eight by eight; the four cells of the town are one ward
    assert joined(wards) == everywhere
    assert sum(border.gate is not None for border in wards.borders) == len(everywhere) - 1


def test_with_all_loops_every_border_has_a_way() -> None:
    assert all(border.gate is not None for border in wards_with(loops=1.0).borders)


def test_ways_are_counted_at_both_ends() -> None:
    wards = wards_with(loops=0.0)
    assert wards.ways.sum() == 2 * 60
    assert (wards.ways[np.unique(wards.numbers)] >= 1).all()


@pytest.mark.parametrize(
    ("kind", "barrier"),
    [("walls", Barrier.WALL), ("thickets", Barrier.THICKET), ("canyons", Barrier.RIDGE)],
)
def test_only_barriers_with_a_weight_occur(kind: str, barrier: Barrier) -> None:
    weights = dict.fromkeys(("walls", "thickets", "canyons", "terraces"), 0.0) | {kind: 0.5}
    assert {border.barrier for border in wards_with(**weights).borders} == {barrier, Barrier.TOWN_WALL}


def test_neighbouring_terraces_differ_in_level_except_around_a_town() -> None:
    wards = wards_with(walls=0.0, thickets=0.0, canyons=0.0, terraces=1.0)
    cliffs = [border for border in wards.borders if border.barrier is Barrier.CLIFF]
    assert len(cliffs) > 40
    assert all(wards.levels[left] != wards.levels[right] for left, right in (c.wards for c in cliffs))
    around = wards.numbers[0:4, 1:5]
    assert not wards.levels[around].any()


def test_every_point_of_the_ground_is_in_the_ward_around_it() -> None:
    wards = wards_with(3)
    terrain = Terrain((-100.0, -100.0), np.zeros((101, 101)), -np.inf)
    found = ward_of_points(wards, terrain)
    corners = wards.corners
    middles = (corners[:-1, :-1] + corners[1:, :-1] + corners[:-1, 1:] + corners[1:, 1:]) / 4.0
    rows, columns = ((middles[..., axis] + 100.0) / 2.0 + 0.5 for axis in (1, 0))
    assert (found[rows.astype(int), columns.astype(int)] == wards.numbers).all()
    assert set(np.unique(found)) == set(np.unique(wards.numbers))


def test_barriers_need_a_weight() -> None:
    with pytest.raises(ValueError, match="one of them must be above 0"):
        Country(walls=0.0, thickets=0.0, canyons=0.0, terraces=0.0)
