"""The base class of sensors that make the images of many matches in one call, each with what moves in it."""

from abc import abstractmethod
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.parallel.turns import ALONE, Turns, items_of
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.dynamic_objects import ObjectSets
from wildscav_engine.rendering.tracing.solids import Solids
from wildscav_engine.rendering.tracing.workspace import LARGEST_CACHED
from wildscav_engine.sensors.optics.dynamic_objects import as_dynamic_objects
from wildscav_engine.sensors.optics.optical import NO_DYNAMIC_OBJECTS, OpticalSensor, select_cameras
from wildscav_engine.sensors.optics.shown_maps import ShownMap, ShownMaps

if TYPE_CHECKING:
    from wildscav_engine.maps.game_map import GameMap


class BatchedOpticalSensor(OpticalSensor):
    """A sensor that reads many matches in one call."""

    @abstractmethod
    def write_images(
        self,
        shown: ShownMap | ShownMaps,
        objects: ObjectSets,
        matches: NDArray[np.int64],
        cameras: Cameras,
        images: NDArray[Any],
        turns: Turns,
    ) -> bool:
        """Render the images of cameras in different matches.

        Args:
            shown: The map of each camera, or one for all.
            objects: The dynamic objects of some matches.
            matches: (N,) the index in ``objects`` of the match that each camera is in.
            cameras: N cameras.
            images: (N, *shape), written.
            turns: In which order to render them, with other threads.

        Returns:
            Whether all numbers of the cameras are finite; if not, nothing is written.
        """

    def render_into(
        self, game_map: "GameMap", moving: Solids, cameras: Cameras, images: NDArray[Any]
    ) -> bool:
        """Render the images of some cameras."""
        objects = as_dynamic_objects(moving).sets
        return self.write_images(
            ShownMap(game_map), objects, _in_one_match(len(images)), cameras, images, ALONE
        )

    def render_matches_into(
        self,
        shown: ShownMaps,
        objects: ObjectSets,
        matches: NDArray[np.int64],
        cameras: Cameras,
        images: NDArray[Any],
        turns: Turns = ALONE,
    ) -> bool:
        """Render the images of cameras in different matches; see ``write_images``."""
        if self.rays <= LARGEST_CACHED:
            return self.write_images(shown, objects, matches, cameras, images, turns)
        # What one of them is traced in is large, so only one is used at a time.
        parts = (slice(row, row + 1) for row in items_of(turns, len(images)))
        return all(
            self.write_images(
                ShownMap(shown.maps[part.start]),
                objects,
                matches[part],
                select_cameras(cameras, part),
                images[part],
                ALONE,
            )
            for part in parts
        )

    def render_maps_into(
        self, shown: ShownMaps, cameras: Cameras, images: NDArray[Any], turns: Turns = ALONE
    ) -> bool:
        """Render the images of some cameras on maps without dynamic objects."""
        nothing = NO_DYNAMIC_OBJECTS.sets
        return self.render_matches_into(shown, nothing, _in_one_match(len(images)), cameras, images, turns)


@lru_cache(maxsize=64)
def _in_one_match(count: int) -> NDArray[np.int64]:
    """Return the indices of the matches of ``count`` cameras that are all in the first one."""
    return np.zeros(count, np.int64)
