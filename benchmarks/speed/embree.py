"""Intel Embree through its Python binding ``embreex``, over the exported mesh of a world."""

from typing import NamedTuple

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from wildscav_engine.geometry.world import World
from wildscav_engine.maps.export.mesh import solids_mesh, terrain_mesh

FIELD_OF_VIEW = 60.0  # degrees
Rays = tuple[NDArray[np.float32], NDArray[np.float32]]  # (n, 3) m where they start, and (n, 3) unit vectors


class Mesh(NamedTuple):
    """Terrain and solids."""

    vertices: NDArray[np.float32]  # (V, 3) m
    triangles: NDArray[np.int32]  # (T, 3) vertices
    solids: NDArray[np.int32]  # (T,) the solid that a triangle belongs to, -1 for terrain


def mesh_of(world: World) -> Mesh:
    """Return the exported mesh of a world, without its water."""
    terrain, solids = terrain_mesh(world), solids_mesh(world)
    return Mesh(
        np.concatenate([terrain.vertices, solids.vertices]),
        np.concatenate([terrain.triangles, solids.triangles + np.int32(len(terrain.vertices))]),
        np.concatenate([terrain.solids, solids.solids]),
    )


class Tracer:
    """A mesh in Embree."""

    def __init__(self, mesh: Mesh) -> None:
        self._scene = EmbreeScene()
        self._mesh = TriangleMesh(self._scene, mesh.vertices, mesh.triangles)

    def distances(
        self,
        origins: NDArray[np.float32],
        rays: NDArray[np.float32],
        reach: NDArray[np.float32],
    ) -> NDArray[np.float32]:
        """Return (n,) m to the hits of rays, in the array of their reaches, which stay where nothing is hit.

        This is the cheapest of the binding's queries that returns distances.
        """
        met: NDArray[np.float32] = self._scene.run(origins, rays, query="DISTANCE", dists=reach)
        return met

    def triangles(
        self, origins: NDArray[np.float32], rays: NDArray[np.float32], reach: NDArray[np.float32]
    ) -> NDArray[np.int32]:
        """Return (n,) the triangles that rays hit, -1 where nothing is hit."""
        met: NDArray[np.int32] = self._scene.run(origins, rays, query="INTERSECT", dists=reach)
        return met


def directions(yaw: float, pitch: float, width: int, height: int) -> NDArray[np.float64]:
    """Return (height * width, 3) unit vectors through the middles of pixels, row after row from the top."""
    sin_yaw, cos_yaw = np.sin(np.radians(yaw)), np.cos(np.radians(yaw))
    sin_pitch, cos_pitch = np.sin(np.radians(pitch)), np.cos(np.radians(pitch))
    pixel = 2.0 * np.tan(np.radians(FIELD_OF_VIEW / 2.0)) / width
    up = ((height / 2 - np.arange(height) - 0.5) * pixel)[:, None]
    right = ((np.arange(width) + 0.5 - width / 2) * pixel)[None, :]
    level, rise = cos_pitch + sin_pitch * up, cos_pitch * up - sin_pitch + 0.0 * right
    rays = np.stack([sin_yaw * level + cos_yaw * right, rise, cos_yaw * level - sin_yaw * right], axis=-1)
    unit: NDArray[np.float64] = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
    return unit.reshape(-1, 3)


def rays_of(position: NDArray[np.float64], yaw: float, pitch: float, width: int, height: int) -> Rays:
    """Return the rays of an image as Embree takes them."""
    rays = directions(yaw, pitch, width, height).astype(np.float32)
    return np.tile(position.astype(np.float32), (len(rays), 1)), rays
