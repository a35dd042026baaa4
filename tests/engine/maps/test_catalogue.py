"""The numbered maps: the paper's six according to its table, and one for every other id."""

from collections.abc import Iterator

import numpy as np
import pytest

from wildscav_engine.maps import GameMap, MapError, cache, load_map, map_spec
from wildscav_engine.maps.catalogue import BENCHMARK, LAST_ID
from wildscav_engine.maps.layout import lay_out
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.match_spec import MatchSpec

# The table of the paper's appendix: size in m, houses, density, storeys.
TABLE = {
    8: (500, 12, "low", (2, 3)),
    14: (500, 15, "high", (2, 3)),
    101: (200, 4, "low", (1, 1)),
    102: (200, 8, "high", (2, 3)),
    103: (100, 2, "low", (1, 1)),
    104: (100, 4, "high", (2, 3)),
}
LAYABLE = 500  # m, maps up to this size are laid out in a test; larger ones take longer
EVERY = 28  # one map in so many is laid out


@pytest.fixture(scope="module", autouse=True)
def nothing_kept(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Generate the maps anew instead of loading those cached by an earlier run."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cache, "folder", lambda: tmp_path_factory.getbasetemp() / "maps")
        cache.map_of.cache_clear()
        yield
        cache.map_of.cache_clear()


@pytest.mark.parametrize("map_id", TABLE)
def test_a_map_of_the_benchmark_is_as_the_papers_table_says(map_id: int) -> None:
    config = map_spec(map_id).config

    assert (config.size, config.houses, config.density, config.storeys) == TABLE[map_id]
    assert BENCHMARK.keys() == TABLE.keys()


@pytest.mark.parametrize(
    "map_id", [*(pytest.param(great, marks=pytest.mark.slow) for great in (8, 14)), 101, 102, 103, 104]
)
def test_a_map_of_the_benchmark_is_built_as_configured(map_id: int) -> None:
    size, houses, _, (low, high) = TABLE[map_id]
    game_map = load_map(map_id)

    assert game_map.spec == map_spec(map_id)
    assert game_map.world.heights.shape == (size / 2 + 1, size / 2 + 1)
    assert len(game_map.houses) == houses
    assert {house.storeys for house in game_map.houses} <= set(range(low, high + 1))


def boxes_by_distance(game_map: GameMap, seed: int) -> np.ndarray:
    """Return how many of a gathering match's boxes lie 0–30, 30–60 and 60–90 m from the middle of its map."""
    match = Match(MatchSpec(track="gathering", map=game_map.spec, seed=seed), game_map)
    supplies = match.state.supplies
    there = supplies.position[0][supplies.quantity[0] > 0]
    return np.histogram(np.hypot(there[:, 0], there[:, 2]), [0, 30, 60, 90])[0]


def test_supplies_of_map_101_are_denser_near_the_center() -> None:
    boxes = sum(boxes_by_distance(load_map(101), seed) for seed in range(5))
    near, middle, far = boxes / [1, 3, 5]  # the rings' areas, the innermost being 1

    assert near > 1.5 * middle > 1.5 * 1.5 * far


@pytest.mark.parametrize("map_id", [0, -1, 1000, True, "8", 8.0, None])
def test_an_id_that_does_not_exist_is_refused_in_one_line(map_id: object) -> None:
    with pytest.raises(MapError) as refused:
        load_map(map_id)  # type: ignore[arg-type]

    assert str(refused.value) == f"id is {map_id!r}; maps have the ids 1 to 999"


def test_every_id_has_a_map_of_its_own() -> None:
    specs = [map_spec(map_id) for map_id in range(1, LAST_ID + 1)]

    assert len(set(specs)) == 999
    # The middle of the map with seed 1 would be a lake.
    assert {number: spec.seed for number, spec in enumerate(specs, 1) if spec.seed != number} == {1: 3001}
    assert len({spec.config for spec in specs}) > 950  # hardly any two have the same config
    assert {spec.config.size for spec in specs} >= {80, 2000}
    assert {storeys for spec in specs for storeys in spec.config.storeys} == {1, 2, 3, 4}


@pytest.mark.parametrize("map_id", [1, 222, 355, 444, 560])
def test_the_hundreds_say_the_size_and_odd_ids_have_scattered_houses(map_id: int) -> None:
    config = map_spec(map_id).config

    assert config.size == {0: 500, 2: 80, 3: 140, 4: 300, 5: 500}[map_id // 100]
    assert config.density == ("low" if map_id % 2 else "high")


@pytest.mark.slow
def test_maps_of_the_catalogue_have_room_for_what_they_ask_for() -> None:
    specs = [map_spec(map_id) for map_id in range(1, LAST_ID + 1, EVERY)]
    layable = [spec for spec in specs if spec.config.size <= LAYABLE]

    assert len({spec.config.size for spec in layable}) > 3
    for spec in layable:
        assert len(lay_out(spec.config, spec.seed).houses) == spec.config.houses, spec
