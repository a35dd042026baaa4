"""The map bank: worlds of several maps as flat arrays, so that matches on different maps share a batch."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import World
from wildscav_engine.kernel import array_kernel
from wildscav_engine.maps.game_map import GameMap

LIMIT = 128  # maps in a bank before those that no match is played on are dropped


class MapBank(NamedTuple):
    """The worlds of M maps end to end; ``world_of`` takes one out without copying."""

    shape: NDArray[np.int64]  # (M, 4) rows and columns of cells, rows and columns of blocks
    start: NDArray[np.int64]  # (M + 1, 13) where each map's part of each flat array below starts
    corner: NDArray[np.float64]  # this and the following: as in World, flattened
    heights: NDArray[np.float64]
    water: NDArray[np.float64]
    cell_top: NDArray[np.float64]
    block_top: NDArray[np.float64]
    cell_start: NDArray[np.int64]
    cell_solids: NDArray[np.int64]
    solid_box: NDArray[np.float64]  # low, then high corners
    solid_start: NDArray[np.int64]
    faces: NDArray[np.float64]
    face_reach: NDArray[np.float64]
    solid_kind: NDArray[np.int8]
    spawns: NDArray[np.float64]


def build_bank(worlds: Sequence[World]) -> MapBank:
    """Lay worlds end to end."""
    parts = [_parts(world) for world in worlds]
    lengths = np.array([[part.size for part in row] for row in parts], np.int64)
    start = np.zeros((len(worlds) + 1, lengths.shape[1]), np.int64)
    start[1:] = np.cumsum(lengths, axis=0)
    shape = np.array([[*world.water.shape, *world.block_top.shape] for world in worlds], np.int64)
    flat = [np.concatenate([row[index].reshape(-1) for row in parts]) for index in range(lengths.shape[1])]
    return MapBank(shape, start, *flat)


class GrowingBank:
    """A bank that takes maps in as matches are played on them, and drops old ones when it has too many."""

    def __init__(self, maps: Sequence[GameMap], limit: int = LIMIT) -> None:
        """Put some maps into the bank."""
        self._limit = limit
        self._maps: dict[int, GameMap] = {id(game_map): game_map for game_map in maps}
        self._rebuild()

    def add(self, maps: Sequence[GameMap], in_use: Sequence[GameMap]) -> None:
        """Take in those of some maps that are not here; drop the oldest not in use if there are too many.

        The numbers of all maps may change.
        """
        new = {id(game_map): game_map for game_map in maps if id(game_map) not in self._maps}
        if not new:
            return
        self._maps.update(new)
        used = {id(game_map) for game_map in in_use}
        for key in list(self._maps):
            if len(self._maps) <= self._limit:
                break
            if key not in used:
                del self._maps[key]
        self._rebuild()

    def index_of(self, game_map: GameMap) -> int:
        """Return the number of a map that is here."""
        return self._places[id(game_map)]

    def _rebuild(self) -> None:
        self._places = {key: index for index, key in enumerate(self._maps)}
        self.bank = build_bank([game_map.world for game_map in self._maps.values()])


def _parts(world: World) -> list[NDArray[np.generic]]:
    """Return a world's arrays in the order of the bank."""
    return [
        world.corner,
        world.heights,
        world.water,
        world.cell_top,
        world.block_top,
        world.cell_start,
        world.cell_solids,
        np.stack([world.solid_low, world.solid_high]),
        world.solid_start,
        world.faces,
        world.face_reach,
        world.solid_kind,
        world.spawns,
    ]


@array_kernel
def world_of(bank: MapBank, index: int) -> World:
    """Return one map's world as views of the bank."""
    rows, columns = bank.shape[index, 0], bank.shape[index, 1]
    block_rows, block_columns = bank.shape[index, 2], bank.shape[index, 3]
    first, last = bank.start[index], bank.start[index + 1]
    box = bank.solid_box[first[7] : last[7]]
    half = box.shape[0] // 2
    return World(
        bank.corner[first[0] : last[0]],
        bank.heights[first[1] : last[1]].reshape((rows + 1, columns + 1)),
        bank.water[first[2] : last[2]].reshape((rows, columns)),
        bank.cell_top[first[3] : last[3]].reshape((rows, columns)),
        bank.block_top[first[4] : last[4]].reshape((block_rows, block_columns)),
        bank.cell_start[first[5] : last[5]],
        bank.cell_solids[first[6] : last[6]],
        box[:half].reshape((half // 3, 3)),
        box[half:].reshape((half // 3, 3)),
        bank.solid_start[first[8] : last[8]],
        bank.faces[first[9] : last[9]].reshape(((last[9] - first[9]) // 4, 4)),
        bank.face_reach[first[10] : last[10]],
        bank.solid_kind[first[11] : last[11]],
        bank.spawns[first[12] : last[12]].reshape(((last[12] - first[12]) // 3, 3)),
    )
