"""The numbered maps 1 to 999: the six of the paper's benchmark, and a distinct one for every other id.

The paper's table gives size, number of houses, density and storeys of maps 008, 014 and 101 to 104;
everything else is the generator's default. The paper's cooperative tasks, played on 101, had supplies
"distributed denser near the center of the map and sparser far away from the center".

For any other id, the hundreds select the size, odd ids have scattered houses and even ones houses close
together, the seed is the id (except for those in ``SEEDS``), and the rest is drawn from the id.
"""

from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.maps.cache import map_of
from wildscav_engine.maps.errors import MapError
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.supply_config import SupplyConfig, SupplyWave

LAST_ID = 999
SIZES = (500, 200, 80, 140, 300, 500, 700, 1000, 1400, 2000)  # m, by the hundreds of an id
STOREYS = ((1, 1), (1, 2), (2, 2), (1, 3), (2, 3), (2, 4), (1, 4))
NEAR_CENTER = SupplyConfig(
    waves=(SupplyWave(center=(0.0, 0.0), radius=40.0, outdoor_richness=50.0, indoor_richness=90.0),),
    spacing=5.0,
)

# The examples of the original client walk from the middle of map 1 to (5, 0, 5), at 1 m/s for 10 s; with seed
# 1 there would be a lake.
SEEDS = {1: 3001}
# The table of the paper's appendix, "Generation configurations of the benchmark maps".
BENCHMARK = {
    8: MapConfig(size=500, houses=12, density="low", storeys=(2, 3)),
    14: MapConfig(size=500, houses=15, density="high", storeys=(2, 3)),
    101: MapConfig(size=200, houses=4, density="low", storeys=(1, 1), supplies=NEAR_CENTER),
    102: MapConfig(size=200, houses=8, density="high", storeys=(2, 3)),
    103: MapConfig(size=100, houses=2, density="low", storeys=(1, 1)),
    104: MapConfig(size=100, houses=4, density="high", storeys=(2, 3)),
}


def map_spec(map_id: int) -> MapSpec:
    """Return the spec of a numbered map.

    Args:
        map_id: 1 to 999.

    Raises:
        MapError: There is no such id.
    """
    if isinstance(map_id, bool) or not isinstance(map_id, int) or not 1 <= map_id <= LAST_ID:
        raise MapError(f"id is {map_id!r}; maps have the ids 1 to {LAST_ID}")
    config = BENCHMARK.get(map_id)
    return MapSpec(config=config if config else _config_of(map_id), seed=SEEDS.get(map_id, map_id))


def load_map(map_id: int) -> GameMap:
    """Return a numbered map, from memory or disk if it is cached there.

    Args:
        map_id: 1 to 999.

    Raises:
        MapError: There is no such id.
    """
    return map_of(map_spec(map_id))


def _config_of(map_id: int) -> MapConfig:
    """Return the config of an id that is not in the benchmark."""
    dice = RandomStream(map_id, Stream.CATALOGUE)
    size = SIZES[map_id // 100]
    return MapConfig(
        size=size,
        houses=dice.integer(max(1, size // 45), size // 27),
        density="low" if map_id % 2 else "high",
        storeys=STOREYS[dice.integer(0, len(STOREYS) - 1)],
        relief=round(dice.uniform(0.5, 1.5), 2),
        ruggedness=round(dice.uniform(0.0, 1.0), 2),
        water=round(dice.uniform(0.0, 0.2), 2),
        vegetation=round(dice.uniform(0.2, 0.8), 2),
    )
