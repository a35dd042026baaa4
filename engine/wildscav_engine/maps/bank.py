"""The map bank: the addresses of several maps' worlds, so that matches on different maps share a batch."""

from collections.abc import Sequence

import numpy as np

from wildscav_engine.compilation.tables.array_tables import ArrayTable, reader
from wildscav_engine.geometry.world import empty_world
from wildscav_engine.maps.game_map import GameMap

# What a bank has before those maps are dropped that no match is played on.
LIMIT = 128  # maps
MEMORY = 500_000_000  # bytes

# A kernel that reads a world from its table without copying.
world_at = reader(empty_world())


class MapBank:
    """Maps by their numbers in a batch. Maps are added as they are needed; their arrays are not copied.

    Attributes:
        addresses: (M, F, 6) the table of each map's world, for ``world_at``.
    """

    def __init__(self, maps: Sequence[GameMap] = (), limit: int = LIMIT) -> None:
        """Start with some maps, and keep up to ``limit`` maps that are not in use."""
        self._limit = limit
        self._maps: dict[int, GameMap] = {}
        self._worlds: dict[int, ArrayTable] = {}
        self.add(maps, in_use=maps)

    def add(self, maps: Sequence[GameMap], in_use: Sequence[GameMap]) -> bool:
        """Add the maps that are not in the bank; drop the oldest ones not in use if there are too many.

        Returns:
            Whether any map was new. If so, the numbers of all maps may have changed.
        """
        new = {id(game_map): game_map for game_map in maps if id(game_map) not in self._maps}
        if not new:
            return False
        self._maps.update(new)
        self._worlds.update((key, ArrayTable(game_map.world)) for key, game_map in new.items())
        used = {id(game_map) for game_map in in_use}
        taken = sum(game_map.memory for game_map in self._maps.values())
        for key in [key for key in self._maps if key not in used]:
            if len(self._maps) <= self._limit and taken <= MEMORY:
                break
            taken -= self._maps.pop(key).memory
            del self._worlds[key]
        self._number()
        return True

    def index_of(self, game_map: GameMap) -> int:
        """Return the number of a map in the bank."""
        return self._numbers[id(game_map)]

    def fork(self) -> "MapBank":
        """Return an independent bank with the same maps under the same numbers."""
        return MapBank(list(self._maps.values()), self._limit)

    def __reduce__(self) -> tuple[type["MapBank"], tuple[list[GameMap], int]]:
        """Copy and pickle the maps; addresses are taken anew."""
        return MapBank, (list(self._maps.values()), self._limit)

    def _number(self) -> None:
        self._numbers = {key: number for number, key in enumerate(self._maps)}
        self.addresses = np.array([world.addresses for world in self._worlds.values()], np.int64)
