"""A map as everything else sees it."""

from dataclasses import dataclass
from functools import cached_property
from hashlib import blake2b

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import World
from wildscav_engine.spec import MapConfig, MapSpec


@dataclass(frozen=True)
class House:
    """Where a house stands: a rectangle turned about its middle."""

    center: tuple[float, float]  # m, x and z
    size: tuple[float, float]  # m, width and depth before turning
    yaw: float  # degrees
    ground: float  # m, height of its ground floor
    storeys: int
    storey_height: float  # m


@dataclass(frozen=True, eq=False)
class GameMap:
    """The static world of matches, made from a config and a seed."""

    spec: MapSpec
    world: World
    houses: tuple[House, ...]
    indoor: NDArray[np.float64]  # (I, 3) m, standing places inside houses that can be reached
    outdoor: NDArray[np.float64]  # (O, 3) m, standing places on open ground that can be reached
    solid_house: NDArray[np.int16]  # (S,) the house that a solid belongs to, -1 for none

    @property
    def config(self) -> MapConfig:
        """The kind of map this is."""
        return self.spec.config

    @cached_property
    def digest(self) -> str:
        """A digest of everything in the map, 16 hexadecimal digits."""
        digest = blake2b(digest_size=8)
        for array in (*self.world, self.indoor, self.outdoor, self.solid_house):
            digest.update(f"{array.dtype.str}{array.shape}".encode() + array.tobytes())
        return digest.hexdigest()
