"""Pools of maps: the right number, generated once, and disjoint for training and testing."""

import pytest

from wildscav_engine.maps import MapError
from wildscav_engine.maps.pools import LEVELS, PARITY, MapPool, numbered_maps, random_maps
from wildscav_engine.specs.map_spec import MapConfig, MapSpec

TINY = MapConfig(size=40, houses=0, vegetation=0.1)


def seeds(pool: MapPool) -> set[int]:
    return {spec.seed for choices in pool._choices for spec in choices}


@pytest.mark.parametrize("level", LEVELS)
def test_no_map_is_both_to_train_and_to_test_on(level: str) -> None:
    train = set().union(*(seeds(random_maps(level, "train", seed)) for seed in range(3)))
    test = set().union(*(seeds(random_maps(level, "test", seed)) for seed in range(3)))
    assert not train & test
    assert len(train) == len(test) == 3 * 64 * 16


def test_environments_share_the_maps_of_a_pool_and_each_is_made_once() -> None:
    pool = random_maps(TINY, "train", 1, 3)
    assert pool is random_maps(TINY, "train", 1, 3)
    assert len(pool) == 3
    assert pool.draw(7) is pool[1]
    assert len({pool[number].digest for number in range(3)}) == 3
    with pytest.raises(IndexError, match="the maps are 0 to 2"):
        pool[3]


def test_a_seed_without_room_is_passed_over() -> None:
    crowded = MapSpec(config=MapConfig(size=40, houses=50))
    assert MapPool([[crowded, MapSpec(config=TINY)]])[0].config == TINY
    with pytest.raises(MapError, match="houses is 50"):
        MapPool([[crowded]])[0]


def test_numbered_maps_make_a_pool() -> None:
    assert numbered_maps((103, 104))._choices[1][0].seed == 104
    with pytest.raises(MapError, match="1 to 999"):
        numbered_maps((0,))


def test_levels_are_of_growing_size_and_the_last_one_is_a_maze() -> None:
    assert [config.size for config in LEVELS.values()] == [100, 200, 300, 200]
    assert [level for level, config in LEVELS.items() if config.country] == ["expert"]


def test_no_pool_has_a_map_that_evaluations_keep_for_themselves() -> None:
    drawn = set().union(*(seeds(random_maps("easy", split, seed)) for split in PARITY for seed in range(5)))
    assert max(drawn) < 2**63
