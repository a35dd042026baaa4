"""Ground made by hand, and where houses stand on it."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import Solid
from wildscav_engine.maps import GameMap, House
from wildscav_engine.maps.ground.terrain import Terrain


def level_ground(size: int, slope: float = 0.0, water_level: float = -np.inf) -> Terrain:
    """Return level ground, or ground that rises eastwards through height 0."""
    across = np.arange(size // 2 + 1) * 2.0 - size / 2
    return Terrain((-size / 2, -size / 2), np.tile(across * slope, (len(across), 1)), water_level)


def footprint_of(house: House) -> NDArray[np.float64]:
    """Return the footprint of a house as kernels take it."""
    return np.array((*house.pose, house.size[0] / 2, house.size[1] / 2))


def middle_of(solid: Solid) -> NDArray[np.float64]:
    """Return x and z of the middle of a solid."""
    return ((solid.low + solid.high) / 2)[[0, 2]]


def lost_rooms(game_map: GameMap) -> list[tuple[int, int]]:
    """Return the house and the storey of every room without an indoor place."""
    x, y, z = game_map.indoor.T
    lost = []
    for number, house in enumerate(game_map.houses):
        across, along = house.pose.inside(x, z)
        for level, (left, back, right, front) in house.rooms:
            within = (across > left) & (across < right) & (along > back) & (along < front)
            if not (within & (np.abs(y - house.ground - level * house.storey_height) < 0.2)).any():
                lost.append((number, level))
    return lost
