"""What the rays of cameras meet first."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.rays import TERRAIN_HIT, cast_ray, make_ray
from wildscav_engine.geometry.world import CELL, World
from wildscav_engine.kernel import kernel
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.solids import Solids, solids_of_world
from wildscav_engine.trig import cosine, sine

WATER_HIT = -3


class Scene(NamedTuple):
    """What images of a world are made from."""

    world: World
    solids: Solids


class Hits(NamedTuple):
    """What each ray of N images met."""

    distance: NDArray[np.float32]  # (N, H, W) m along the ray, inf where nothing is met
    solid: NDArray[np.int32]  # (N, H, W) see below
    face: NDArray[np.int32]  # (N, H, W) see below

    # solid: index of the world's solid; from the number of these on, of the moving ones; TERRAIN_HIT,
    # WATER_HIT or NOTHING_HIT.
    # face: index into Solids.faces of the world or the moving ones; for terrain 2 * cell + 0 for its
    # south-eastern triangle, + 1 for the other; for water the cell (row * columns + column); else 0.


def scene_of(world: World) -> Scene:
    """Prepare a world for images."""
    return Scene(world, solids_of_world(world))


def allocate_hits(count: int, height: int, width: int) -> Hits:
    """Return room for the hits of some images."""
    shape = (count, height, width)
    return Hits(np.empty(shape, np.float32), np.empty(shape, np.int32), np.empty(shape, np.int32))


def trace(scene: Scene, moving: Solids, cameras: Cameras, hits: Hits, *, with_water: bool = False) -> None:
    """Find what each ray meets first.

    Args:
        scene: The static world.
        moving: What is in it besides.
        cameras: N cameras.
        hits: Of N images, written.
        with_water: Whether rays meet the surface of water; else they go to its bed.
    """
    _trace(scene, moving, cameras, hits, with_water)


@kernel
def _trace(scene: Scene, moving: Solids, cameras: Cameras, hits: Hits, with_water: bool) -> None:
    images, height, width = hits.distance.shape
    for image in range(images):
        yaw, pitch = cameras.yaws[image], cameras.pitches[image]
        sin_yaw, cos_yaw, sin_pitch, cos_pitch = sine(yaw), cosine(yaw), sine(pitch), cosine(pitch)
        pixel = 2.0 * cameras.half_width / width
        for row in range(height):
            up = (height * 0.5 - row - 0.5) * pixel
            level, rise = cos_pitch + sin_pitch * up, cos_pitch * up - sin_pitch
            for column in range(width):
                right = (column + 0.5 - width * 0.5) * pixel
                along = 1.0 / np.sqrt(1.0 + up * up + right * right)
                dx, dz = sin_yaw * level + cos_yaw * right, cos_yaw * level - sin_yaw * right
                way = (dx * along, rise * along, dz * along)
                distance, solid, face = _trace_ray(scene, moving, cameras, image, way, with_water)
                hits.distance[image, row, column] = distance
                hits.solid[image, row, column] = solid
                hits.face[image, row, column] = face


@kernel
def _trace_ray(
    scene: Scene,
    moving: Solids,
    cameras: Cameras,
    image: int,
    way: tuple[float, float, float],
    with_water: bool,
) -> tuple[float, int, int]:
    world = scene.world
    x, y, z = cameras.eyes[image, 0], cameras.eyes[image, 1], cameras.eyes[image, 2]
    hit = cast_ray(world, x, y, z, way[0], way[1], way[2], cameras.far)
    distance, solid, face = hit.distance, hit.solid, hit.face
    rows, columns = world.water.shape
    if solid == TERRAIN_HIT:
        row = int((z + way[2] * distance - world.corner[1]) / CELL)
        column = int((x + way[0] * distance - world.corner[0]) / CELL)
        face += 2 * (min(rows - 1, max(0, row)) * columns + min(columns - 1, max(0, column)))
    if with_water and way[1] < 0.0:
        end = min(distance, cameras.far)
        row = int((z + way[2] * end - world.corner[1]) / CELL)
        column = int((x + way[0] * end - world.corner[0]) / CELL)
        if 0 <= row < rows and 0 <= column < columns and y > world.water[row, column] > y + way[1] * end:
            distance, solid, face = (world.water[row, column] - y) / way[1], -3, row * columns + column
    ray = make_ray(world, x, y, z, way[0], way[1], way[2])
    for thing in range(moving.kind.shape[0]):
        if moving.owner[thing] == cameras.viewers[image]:
            continue
        enter, leave, entered_by = 0.0, min(distance, cameras.far), 0
        for plane in range(moving.face_start[thing], moving.face_start[thing + 1]):
            n_x, n_y, n_z = moving.faces[plane, 0], moving.faces[plane, 1], moving.faces[plane, 2]
            outside = n_x * ray.x + n_y * ray.y + n_z * ray.z - moving.faces[plane, 3]
            speed = n_x * ray.dx + n_y * ray.dy + n_z * ray.dz
            if speed < 0.0:
                if -outside / speed > enter:
                    enter, entered_by = -outside / speed, plane
            elif outside > 0.0:
                leave = -1.0
            elif speed > 0.0:
                leave = min(leave, -outside / speed)
        if enter <= leave:
            distance, solid, face = enter, world.solid_kind.shape[0] + thing, entered_by
    return distance, solid, face
