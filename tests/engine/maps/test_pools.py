"""Pools of maps: the right number, generated once, and disjoint for training and testing."""

import gc
import tracemalloc
import weakref

import pytest

from wildscav_engine.maps import MapError
from wildscav_engine.maps.levels import LEVELS
from wildscav_engine.maps.pools import PARITY, MapPool, numbered_maps, random_maps
from wildscav_engine.specs.map_spec import MapConfig, MapSpec

TINY = MapConfig(size=40, houses=0, vegetation=0.1)


def seeds(pool: MapPool) -> set[int]:
    return {spec.seed for number in range(len(pool)) for spec in pool.specs(number)}


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


def test_a_pool_goes_with_those_who_have_it_and_takes_nothing_for_maps_that_nobody_drew() -> None:
    tracemalloc.start()
    pool = random_maps(TINY, "train", 1, 100_000)
    last = pool.specs(99_999)
    taken, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert len(last) == 16
    assert taken < 1_000_000
    known = weakref.ref(pool)
    del pool
    gc.collect()
    assert known() is None


def test_maps_of_a_pool_are_kept_up_to_a_limit_and_made_again_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WILDSCAV_MAP_MEMORY_MB", "1")
    pool, maps, digests = random_maps(TINY, "train", 2, 30), [], []
    for number in range(30):
        game_map = pool[number]
        assert game_map.scene  # computed later than the map, and larger
        maps.append(weakref.ref(game_map))
        digests.append(game_map.digest)
        del game_map
        pool[number]
        assert sum(one.memory for known in maps if (one := known())) <= 1_000_000
    assert maps[0]() is None
    assert maps[-2]() is pool[28]
    assert pool[0].digest == digests[0]
    monkeypatch.setenv("WILDSCAV_MAP_MEMORY_MB", "much")
    with pytest.raises(MapError, match="WILDSCAV_MAP_MEMORY_MB is 'much', must be a whole number of megabyt"):
        random_maps(TINY, "train", 3)


def test_a_seed_without_room_is_passed_over() -> None:
    crowded = MapSpec(config=MapConfig(size=40, houses=50))
    assert MapPool(1, [[crowded, MapSpec(config=TINY)]].__getitem__)[0].config == TINY
    with pytest.raises(MapError, match="houses is 50"):
        MapPool(1, [[crowded]].__getitem__)[0]


def test_numbered_maps_make_a_pool() -> None:
    assert numbered_maps((103, 104)).specs(1)[0].seed == 104
    with pytest.raises(MapError, match="1 to 999"):
        numbered_maps((0,))


def test_no_pool_has_a_map_that_evaluations_keep_for_themselves() -> None:
    drawn = set().union(*(seeds(random_maps("easy", split, seed)) for split in PARITY for seed in range(5)))
    assert max(drawn) < 2**63
