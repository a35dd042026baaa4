"""The depth camera: planar depth of the static world through a pinhole.

Depth is measured along the view axis, not along the ray: a wall seen straight on reads the same in every
pixel. Surfaces farther than ``far`` along their ray read ``far``. Agents and supply boxes are invisible
unless the option ``moving`` is set.
"""

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wildscav_engine.compilation.kernel import argument_error
from wildscav_engine.parallel.turns import ALONE, Turns
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.dynamic_objects import ObjectSets
from wildscav_engine.rendering.images import Output
from wildscav_engine.rendering.trace import depths_tracer, trace_static_depths
from wildscav_engine.rendering.tracing.solids import Solids
from wildscav_engine.rendering.tracing.workspace import Size
from wildscav_engine.sensors.base import sensor
from wildscav_engine.sensors.optics.image_sensor import ShownMaps, are_ready
from wildscav_engine.sensors.optics.pinhole import TracedCamera

if TYPE_CHECKING:
    from wildscav_engine.maps.game_map import GameMap
    from wildscav_engine.simulation.match_view import MatchView

DEPTH = np.dtype(np.float32)


@sensor
class DepthCamera(TracedCamera):
    """Depth maps in metres."""

    name: ClassVar[str] = "depth"
    title: ClassVar[str] = "planar depth, m"
    dtype: ClassVar[type[np.generic]] = np.float32
    ray_time: ClassVar[int] = 5
    output: ClassVar[Output] = Output.DEPTHS

    moving: bool = False  # whether agents and supply boxes are visible

    def read(self, match: "MatchView", seats: Sequence[int]) -> NDArray[np.float32]:
        """Return the depth maps of some agents, (len(seats), height, width) m; see ``ImageSensor.read``."""
        if self.moving:
            return super().read(match, seats)
        cameras = self.cameras_of(match, seats)
        return self.render(match.game_map, cameras.eyes, cameras.yaws, cameras.pitches)

    @cached_property
    def _size(self) -> Size:
        return Size(self.height, self.width, self.lens[0])

    def render(
        self,
        game_map: "GameMap",
        positions: ArrayLike,
        yaws: ArrayLike,
        pitches: ArrayLike,
        *,
        moving: Solids | None = None,
        viewers: ArrayLike | None = None,
        threads: int = 1,
    ) -> NDArray[np.float32]:
        """Return the depth maps from N positions, (N, height, width) m; see ``ImageSensor.render``."""
        if threads == 1 and moving is viewers is None:
            # The shortest path through the code: a small image is traced in the time of a few Python calls.
            scene, size, lens = game_map.scene, self._size, self.lens
            # The same as ``workspaces.of``, but faster.
            workspace = scene.workspaces.cached.get(size) or scene.workspaces.make(scene.arrays, size)
            trace = depths_tracer()
            try:
                depths = np.empty((len(yaws), size[0], size[1]), DEPTH)  # type: ignore[arg-type]
                if trace(positions, yaws, pitches, lens[0], lens[1], workspace.tables, *ALONE, depths):
                    return depths
            except (TypeError, ValueError, argument_error()):
                if are_ready(positions, yaws, pitches):
                    raise  # the arguments are valid, so the error is ours
        return super().render(
            game_map, positions, yaws, pitches, moving=moving, viewers=viewers, threads=threads
        )

    def write_images(
        self,
        shown: ShownMaps,
        objects: ObjectSets,
        matches: NDArray[np.int64],
        cameras: Cameras,
        images: NDArray[np.float32],
        turns: Turns,
    ) -> bool:
        """Write the depths of what the rays hit."""
        if objects.most == 0:
            return trace_static_depths(shown.scenes, self._size, cameras, images, turns)
        return super().write_images(shown, objects, matches, cameras, images, turns)
