"""The map bank: where the worlds of several maps lie, so that matches on different maps share a batch."""

from collections.abc import Sequence

import numpy as np

from wildscav_engine.compilation.array_tables import ArrayTable, reader
from wildscav_engine.geometry.world import empty_world
from wildscav_engine.maps.game_map import GameMap

LIMIT = 128  # maps in a bank before those that no match is played on are dropped

# A kernel: takes a world out of its table, without copying.
world_at = reader(empty_world())


class MapBank:
    """Maps by their numbers in a batch. It takes more in as they are needed; nothing of them is copied.

    Attributes:
        addresses: (M, F, 6) the table of the world of each map, for ``world_at``.
    """

    def __init__(self, maps: Sequence[GameMap] = (), limit: int = LIMIT) -> None:
        """Take some maps in."""
        self._limit = limit
        self._maps: dict[int, GameMap] = {}
        self._worlds: dict[int, ArrayTable] = {}
        self.add(maps, in_use=maps)

    def add(self, maps: Sequence[GameMap], in_use: Sequence[GameMap]) -> bool:
        """Take in those of some maps that are not here; drop the oldest not in use if there are too many.

        Returns:
            Whether any map was new; then the numbers of all maps may have changed.
        """
        new = {id(game_map): game_map for game_map in maps if id(game_map) not in self._maps}
        if not new:
            return False
        self._maps.update(new)
        self._worlds.update((key, ArrayTable(game_map.world)) for key, game_map in new.items())
        used = {id(game_map) for game_map in in_use}
        for key in [key for key in self._maps if key not in used][: max(0, len(self._maps) - self._limit)]:
            del self._maps[key], self._worlds[key]
        self._number()
        return True

    def index_of(self, game_map: GameMap) -> int:
        """Return the number of a map that is here."""
        return self._numbers[id(game_map)]

    def fork(self) -> "MapBank":
        """Return a bank with the same maps under the same numbers, that takes in others on its own."""
        return MapBank(list(self._maps.values()), self._limit)

    def __reduce__(self) -> tuple[type["MapBank"], tuple[list[GameMap], int]]:
        """Copies and pickles are of the maps, which then lie elsewhere."""
        return MapBank, (list(self._maps.values()), self._limit)

    def _number(self) -> None:
        self._numbers = {key: number for number, key in enumerate(self._maps)}
        self.addresses = np.array([world.addresses for world in self._worlds.values()], np.int64)
