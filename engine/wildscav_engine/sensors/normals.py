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
        solids = game_map.scene.solids
        _write_normals(game_map.world.heights, len(solids.kind), solids.faces, moving.faces, *hits, images)


# A call passes its arrays one by one, so it gets no more of them than it needs.
@kernel
def _write_normals(
    heights: NDArray[np.float64],
    of_world: int,
    faces: NDArray[np.float64],
    moving_faces: NDArray[np.float64],
    distances: NDArray[np.float32],
    solids: NDArray[np.int32],
    hit_faces: NDArray[np.int32],
    images: NDArray[np.float32],
) -> None:
    """Write (N, H, W, 3) unit normals of the surfaces that the rays hit.

    Args:
        heights: (R + 1, C + 1) m, of the terrain.
        of_world: Number of the world's solids.
        faces: (F, 4) of these.
        moving_faces: (F', 4) of the moving solids.
        distances: (N, H, W) see ``Hits``.
        solids: (N, H, W) see ``Hits``.
        hit_faces: (N, H, W) see ``Hits``.
        images: Written.
    """
    count, height, width = distances.shape
    for image in range(count):
        for row in range(height):
            for column in range(width):
                solid, face = solids[image, row, column], hit_faces[image, row, column]
                if solid == NOTHING_HIT or distances[image, row, column] == 0.0:
                    normal = (0.0, 0.0, 0.0)
                elif solid == TERRAIN_HIT:
                    normal = _normal_of_ground(heights, face)
                elif solid < of_world:
                    normal = (faces[face, 0], faces[face, 1], faces[face, 2])
                else:
                    normal = (moving_faces[face, 0], moving_faces[face, 1], moving_faces[face, 2])
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
