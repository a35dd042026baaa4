"""The normals camera: the direction that the surface in each pixel faces.

Normals are unit vectors in the axes of the world (x east, y up, z north). They are zero where the ray hits
nothing within ``far``, or where it starts inside a solid. Rays pass through water to its bed. Agents and
supply boxes are invisible unless the option ``moving`` is set.
"""

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT
from wildscav_engine.geometry.world import CELL
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.trace import Hits
from wildscav_engine.rendering.tracing.solids import Solids
from wildscav_engine.sensors.base import sensor
from wildscav_engine.sensors.optics.optical import MovingOption
from wildscav_engine.sensors.optics.pinhole import RayHitCamera

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.maps.game_map import GameMap


@sensor
class NormalCamera(MovingOption, RayHitCamera):
    """Unit normals."""

    name: ClassVar[str] = "normals"
    title: ClassVar[str] = "unit normals of surfaces, in the world's axes"
    dtype: ClassVar[type[np.generic]] = np.float32
    channels: ClassVar[tuple[int, ...]] = (3,)

    moving: bool = False  # whether agents and supply boxes are visible

    @property
    def space(self) -> "Box":
        """(height, width, 3), from -1 to 1."""
        from gymnasium.spaces import Box

        return Box(np.float32(-1.0), np.float32(1.0), self.shape, np.float32)

    def write_pixels(
        self,
        game_map: "GameMap",
        moving: Solids,
        cameras: Cameras,  # noqa: ARG002
        hits: Hits,
        images: NDArray[np.float32],
    ) -> None:
        """Write the normals of the surfaces that the rays hit."""
        scene = game_map.scene
        _write_normals(scene.world.heights, scene.solids, moving, hits, images)


@kernel
def _write_normals(
    heights: NDArray[np.float64], solids: Solids, moving: Solids, hits: Hits, images: NDArray[np.float32]
) -> None:
    """Write (N, H, W, 3) unit normals of the surfaces that the rays hit."""
    count, height, width = hits.distance.shape
    of_world = solids.kind.shape[0]
    for image in range(count):
        for row in range(height):
            for column in range(width):
                solid, face = hits.solid[image, row, column], hits.face[image, row, column]
                if solid == NOTHING_HIT or hits.distance[image, row, column] == 0.0:
                    normal = (0.0, 0.0, 0.0)
                elif solid == TERRAIN_HIT:
                    normal = _normal_of_ground(heights, face)
                elif solid < of_world:
                    faces = solids.faces
                    normal = (faces[face, 0], faces[face, 1], faces[face, 2])
                else:
                    normal = (moving.faces[face, 0], moving.faces[face, 1], moving.faces[face, 2])
                for axis in range(3):
                    images[image, row, column, axis] = normal[axis]


@kernel
def _normal_of_ground(heights: NDArray[np.float64], face: int) -> tuple[float, float, float]:
    """Return the unit normal of a triangle of the terrain, numbered as in ``Hits``."""
    columns = heights.shape[1] - 1
    cell, triangle = face // 2, face % 2
    row, column = cell // columns, cell % columns
    h00, h01 = heights[row, column], heights[row, column + 1]
    h10, h11 = heights[row + 1, column], heights[row + 1, column + 1]
    south_east = triangle == 0
    east = (h01 - h00 if south_east else h11 - h10) / CELL
    north = (h11 - h01 if south_east else h10 - h00) / CELL
    length = np.sqrt(east * east + 1.0 + north * north)
    return -east / length, 1.0 / length, -north / length
