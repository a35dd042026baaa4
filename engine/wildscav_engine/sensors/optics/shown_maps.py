"""The maps that the images of a reading show."""

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

from wildscav_engine.rendering.shading.appearance import Appearances
from wildscav_engine.rendering.trace import Scenes

if TYPE_CHECKING:
    from wildscav_engine.maps.game_map import GameMap


class ShownMaps:
    """The maps that N images show, possibly with repetitions, or one for all.

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

    @cached_property
    def scenes(self) -> Scenes:
        """What rays are traced in."""
        return Scenes([one.scene for one in self.maps])

    @cached_property
    def appearances(self) -> Appearances:
        """What pictures show."""
        return Appearances([one.appearance for one in self.maps])
