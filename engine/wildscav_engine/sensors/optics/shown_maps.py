"""The maps that the images of a reading show."""

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

from wildscav_engine.rendering.shading.appearance import Appearance, Appearances
from wildscav_engine.rendering.trace import Scene, Scenes

if TYPE_CHECKING:
    from wildscav_engine.maps.game_map import GameMap


class ShownMap:
    """The map that all images show."""

    def __init__(self, game_map: "GameMap") -> None:
        self._map = game_map

    def map_of(self, image: int) -> "GameMap":  # noqa: ARG002
        """Return the map that an image shows."""
        return self._map

    @property
    def scenes(self) -> Scene:
        """What rays are traced in."""
        return self._map.scene

    @property
    def appearances(self) -> Appearance:
        """What pictures show."""
        return self._map.appearance


class ShownMaps:
    """The maps that N images show, possibly with repetitions.

    What kernels need of them is collected once, for many readings. Nobody changes it while they are used.

    Attributes:
        maps: The maps, which have been prepared for the sensors that are read.
    """

    def __init__(self, maps: "Sequence[GameMap]") -> None:
        """Collect maps."""
        self.maps = maps

    def __reduce__(self) -> tuple[type["ShownMaps"], tuple[Any]]:
        """Copy and pickle only the maps: what kernels need is addresses."""
        return ShownMaps, (self.maps,)

    def map_of(self, image: int) -> "GameMap":
        """Return the map that an image shows."""
        return self.maps[image]

    @cached_property
    def scenes(self) -> Scenes:
        """What rays are traced in."""
        return Scenes([one.scene for one in self.maps])

    @cached_property
    def appearances(self) -> Appearances:
        """What pictures show."""
        return Appearances([one.appearance for one in self.maps])
