"""The map that matches are played on."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from hashlib import blake2b
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import World
from wildscav_engine.maps.settlements.houses import House
from wildscav_engine.specs.map_spec import MapConfig, MapSpec

if TYPE_CHECKING:
    from wildscav_engine.maps.walk import NavGraph
    from wildscav_engine.maps.walk.paths import Place
    from wildscav_engine.rendering.shading.appearance import Appearance, Materials
    from wildscav_engine.rendering.trace import Scene

# Incremented by every change that produces a different map from the same config and seed.
GENERATOR_VERSION = 7
MAX_LENGTHS = 10_000  # of shortest ways that a map remembers
SUPPLY_SPACING = 5.0  # m, least distance between indoor places of supplies


@dataclass(frozen=True, eq=False)
class GameMap:
    """The static world of matches, generated from a config and a seed.

    Every one of its indoor and outdoor places can be reached from every other.
    """

    spec: MapSpec
    world: World
    houses: tuple[House, ...]
    indoor: NDArray[np.float64]  # (I, 3) m, standing places inside houses
    outdoor: NDArray[np.float64]  # (O, 3) m, standing places on open ground, then on roofs and rocks
    solid_house: NDArray[np.int16]  # (S,) the house that a solid belongs to, -1 for none
    reachable_share: float = 1.0  # of the ground, 0–1, that is mutually reachable
    # (T, 3) m, where the targets of matches are hidden; none where they may be anywhere
    targets: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 3)))
    # (T, S) how many times as long as the straight line the way is to each of them from each spawn, at least
    detours: NDArray[np.float32] = field(default_factory=lambda: np.zeros((0, 0), np.float32))

    @property
    def config(self) -> MapConfig:
        """The config of the map."""
        return self.spec.config

    @cached_property
    def graph(self) -> "NavGraph":
        """Where a body can go on this map; computing it takes about as long as generating the map."""
        from wildscav_engine.maps.walk import build_graph

        return build_graph(self.world)

    @cached_property
    def _shortest_lengths(self) -> dict[tuple[float, ...], float]:
        """The results of ``shortest_length`` so far."""
        return {}

    def shortest_length(self, start: "Place", target: "Place", reach: float) -> float:
        """Return the length in m of the shortest way to where a target is reached, horizontally.

        The first way that is not straight computes the map's graph. Each way is searched once.

        Args:
            start: x, y, z in m, soles.
            target: The same.
            reach: m, 3D distance of the soles at which the target is reached.
        """
        from wildscav_engine.maps.walk import shortest_length, straight_length

        key = (*map(float, start), *map(float, target), float(reach))
        known = self._shortest_lengths
        if key not in known:
            if len(known) == MAX_LENGTHS:
                known.clear()
            straight = straight_length(self.world, start, target, reach)
            found = straight if straight < np.inf else shortest_length(self.graph, start, target, reach)
            known[key] = found
        return known[key]

    @cached_property
    def supply_points(self) -> NDArray[np.float64]:
        """(N, 3) m, the indoor places where supplies may lie: a subset of all indoor places."""
        from wildscav_engine.maps.locations import keep_apart

        return keep_apart(self.indoor, SUPPLY_SPACING)

    @cached_property
    def ground_points(self) -> NDArray[np.float64]:
        """(N, 3) m, where supplies on a fine grid may lie: the outdoor places, then all open ground."""
        from wildscav_engine.maps.locations import open_ground

        return np.concatenate([self.outdoor, open_ground(self.graph, self.solid_house)])

    @cached_property
    def scene(self) -> "Scene":
        """The scene for images of this map, created on first use."""
        from wildscav_engine.rendering.trace import scene_of

        return scene_of(self.world)

    @cached_property
    def materials(self) -> "Materials":
        """The appearance of this map's surfaces, created on first use."""
        from wildscav_engine.rendering.shading.appearance import materials_of

        return materials_of(self.world, self.solid_house)

    @cached_property
    def appearance(self) -> "Appearance":
        """The world and the materials of this map in the form for pictures, created on first use."""
        from wildscav_engine.rendering.shading.appearance import Appearance

        return Appearance(self.world, self.materials)

    @cached_property
    def _weighed(self) -> list[int]:
        """How much of the map had been computed when its memory was counted, and the bytes."""
        return [0, 0]

    @property
    def memory(self) -> int:
        """The bytes of its arrays, with those of what was computed from it so far."""
        weighed, computed = self._weighed, len(vars(self))
        if weighed[0] != computed:
            arrays: dict[int, NDArray[Any]] = {}
            _collect_arrays(vars(self).values(), arrays)
            weighed[:] = computed, sum(array.nbytes for array in arrays.values())
        return weighed[1]

    @cached_property
    def digest(self) -> str:
        """A digest of everything in the map, 16 hexadecimal digits."""
        digest = blake2b(digest_size=8)
        # The ceiling follows from the solids, and older digests were computed without it.
        world = self.world._asdict()
        del world["ceiling"]
        for array in (*world.values(), self.indoor, self.outdoor, self.solid_house):
            digest.update(f"{array.dtype.str}{array.shape}".encode() + array.tobytes())
        if len(self.targets):
            digest.update(self.targets.tobytes() + self.detours.tobytes())
        return digest.hexdigest()


def _collect_arrays(values: Iterable[Any], arrays: dict[int, NDArray[Any]]) -> None:
    """Add each array in values, tuples and objects among them, once."""
    for value in values:
        if isinstance(value, np.ndarray):
            arrays[id(value)] = value
        elif isinstance(value, tuple | list):
            _collect_arrays(value, arrays)
        elif hasattr(value, "__dict__"):
            _collect_arrays(vars(value).values(), arrays)
