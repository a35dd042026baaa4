"""Pools of maps that episodes are drawn from: random maps of a level, or numbered ones.

Training and test maps are disjoint by construction: random maps of the split ``train`` have even seeds and
those of ``test`` odd ones, for any seed of the pool. All seeds are below 2**63; evaluations use the others.
Numbered maps are the same in both splits.
"""

import functools
from collections.abc import Callable, Hashable, Iterable, Sequence
from typing import Literal
from weakref import WeakValueDictionary

import numpy as np

from wildscav_engine.arithmetic.random_numbers import Stream, philox
from wildscav_engine.maps.cache import map_of, path_of, size_limit
from wildscav_engine.maps.catalogue import map_spec
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.levels import LEVELS, Level
from wildscav_engine.maps.making import first_made, make_maps
from wildscav_engine.specs.map_spec import MapConfig, MapSpec

Split = Literal["train", "test"]

SIZE = 64  # maps in a pool by default
TRIES = 16  # seeds to try for each map of a pool, until its config fits
MEMORY = 2_000_000_000  # bytes of the maps of a pool by default
MEMORY_LIMIT = "WILDSCAV_MAP_MEMORY_MB"  # the environment variable with another limit
PARITY: dict[Split, int] = {"train": 0, "test": 1}  # of the seeds of random maps

_POOLS: WeakValueDictionary[Hashable, "MapPool"] = WeakValueDictionary()  # those that somebody has


class MapPool:
    """Maps numbered from 0; each is generated on first use.

    It is then kept until the maps of the pool take too much memory: those that were not drawn for the longest
    time go first, and are the same, bit for bit, when they are drawn again.
    """

    def __init__(self, size: int, specs: Callable[[int], Sequence[MapSpec]]) -> None:
        """Create a pool.

        Args:
            specs: Returns the specs to try in turn for a map by its number.
        """
        self._size, self._specs, self._limit = size, specs, size_limit(MEMORY_LIMIT, MEMORY)
        self._made: dict[int, GameMap] = {}  # in the order in which they were last drawn
        self._weights: dict[int, int] = {}  # bytes of each

    def __len__(self) -> int:
        """Return the number of maps."""
        return self._size

    @property
    def is_made(self) -> bool:
        """Whether all maps are in memory."""
        return len(self._made) == self._size

    def __getitem__(self, number: int) -> GameMap:
        """Return a map.

        Raises:
            IndexError: There is no such number.
            MapError: The config fits on none of the seeds tried.
        """
        if not 0 <= number < len(self):
            raise IndexError(f"there is no map {number} in the pool; the maps are 0 to {len(self) - 1}")
        known = self._made.pop(number, None)
        game_map = first_made(self.specs(number), map_of) if known is None else known
        self._made[number] = game_map
        self._make_room(list(self._made) if known is None else [number])
        return game_map

    def _make_room(self, changed: Sequence[int]) -> None:
        """Drop maps until the others fit. The maps that may have grown since the last time are given."""
        self._weights |= {number: self._made[number].memory for number in changed}
        taken = sum(self._weights.values())
        for number in list(self._made)[:-1]:
            if taken <= self._limit:
                return
            del self._made[number]
            taken -= self._weights.pop(number)

    def specs(self, number: int) -> tuple[MapSpec, ...]:
        """Return the specs to try in turn for a map; the first that can be generated is the map."""
        return tuple(self._specs(number))

    def draw(self, word: int) -> GameMap:
        """Return the map selected by a random integer."""
        return self[word % len(self)]

    def prepare(self, words: Iterable[int]) -> None:
        """Make all maps that random integers select at once, so that drawing them takes a moment.

        Raises:
            MapError: As for a single map.
        """
        numbers = dict.fromkeys(word % len(self) for word in words)
        maps = {number: self.specs(number) for number in numbers if number not in self._made}
        make_maps(
            {
                number: specs
                for number, specs in maps.items()
                if not any(path_of(spec).exists() for spec in specs)
            },
            self.__getitem__,
        )


def random_maps(
    kind: Level | MapConfig = "normal",
    split: Split = "train",
    seed: int = 0,
    size: int = SIZE,
    *,
    unseen: bool = False,
) -> MapPool:
    """Return a pool of random maps. While somebody has it, equal arguments give the same one.

    Args:
        kind: A level of difficulty, or a config.
        split: Whether the maps are for training or for testing.
        seed: Of the pool.
        size: Number of maps.
        unseen: Whether the maps for testing hold only types of houses and plans of towns that no map for
            training holds.

    Raises:
        ValueError: There are no unseen pieces of such maps; see ``check_unseen``.
    """
    config = kind if isinstance(kind, MapConfig) else LEVELS[kind]
    if unseen:
        check_unseen(config)
        config = config.model_copy(update={"pieces": "seen" if split == "train" else "unseen"})
    specs = functools.partial(_random_specs, config, split, seed)
    return _shared((config, split, seed, size), lambda: MapPool(size, specs))


def _random_specs(config: MapConfig, split: Split, seed: int, number: int) -> list[MapSpec]:
    """Return the specs to try in turn for a map of a random pool."""
    return [MapSpec(config=config, seed=_map_seed(seed, split, number, attempt)) for attempt in range(TRIES)]


def _shared(key: Hashable, make: Callable[[], MapPool]) -> MapPool:
    """Return the pool with a key that is in use, or else a new one."""
    pool = _POOLS.get(key)
    if pool is None:
        pool = _POOLS[key] = make()
    return pool


def check_unseen(config: MapConfig) -> None:
    """Check that maps for testing can hold pieces that no map for training holds.

    Raises:
        ValueError: The config has neither houses nor towns of random types, or chooses the pieces itself.
    """
    if config.pieces != "all":
        raise ValueError(f"unseen is True, but the map config chooses the pieces itself: {config.pieces!r}")
    if config.houses == 0 and (config.country is None or config.country.towns == 0):
        raise ValueError("unseen is True, but the map config has no houses and no towns that could be unseen")


def _map_seed(seed: int, split: Split, number: int, attempt: int) -> int:
    word = int(philox(np.uint64(seed), Stream.MAP_POOL, attempt, 0, number)[0])
    return word // 4 * 2 + PARITY[split]


def numbered_maps(ids: tuple[int, ...]) -> MapPool:
    """Return a pool of numbered maps.

    Raises:
        MapError: One of the ids does not exist.
    """
    specs = [[map_spec(map_id)] for map_id in ids]
    return _shared(ids, lambda: MapPool(len(ids), specs.__getitem__))
