"""Ray tracing for panoramas: how far the rays of a LIDAR go.

Most rings are traced like images, sector by sector; see ``tracing.sectors``. Rings that point steeply up or
down would need images of endless height. Their rays are short, so they are cast one by one.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.array_tables import Addresses
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.rays import Ray, cast_ray, make_ray, meet_faces
from wildscav_engine.geometry.world import CELL, World
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.trace import pack_moving, scratch_in
from wildscav_engine.rendering.tracing.front_to_back import trace_moving_solids, trace_world
from wildscav_engine.rendering.tracing.frustum import MARGIN, Camera
from wildscav_engine.rendering.tracing.hit_buffer import NOTHING, HitBuffer, fill, hit_buffer_in
from wildscav_engine.rendering.tracing.packing import unpack_blocks, unpack_shapes
from wildscav_engine.rendering.tracing.scene import Scene
from wildscav_engine.rendering.tracing.sectors import Optics, Sectors, divide
from wildscav_engine.rendering.tracing.solids import Solids
from wildscav_engine.rendering.tracing.workspace import Size, read_workspace

STEEPEST = 80.0  # degrees up and down of the rings that are traced like images
MIN_COSINE = 1e-12  # rays straight up and down lean by this little
SPHERE = 1.0 + 1e-9  # by which the squares of radii are enlarged to allow for rounding


class Rings(NamedTuple):
    """The rays of each azimuth of a panorama, from the highest to the lowest."""

    levels: NDArray[np.float64]  # (C,) m, horizontal distance per metre of a ray
    rises: NDArray[np.float64]  # (C,) m up per metre


class Panorama:
    """A azimuths at equal angles, the first straight ahead, with C rays each."""

    def __init__(self, azimuths: int, elevations: NDArray[np.float64]) -> None:
        """Prepare for (C,) elevations in degrees above the horizon, descending."""
        self._rings = Rings(np.empty(len(elevations)), np.empty(len(elevations)))
        _aim_rings(elevations, *self._rings)
        self._first = int((elevations > STEEPEST).sum())  # of the rings that are traced like images
        self._last = int((elevations >= -STEEPEST).sum())  # one past the last of them
        self._sectors: Sectors | None = None
        if self._first < self._last:
            self._sectors = divide(azimuths, elevations[self._first : self._last])

    def scan(
        self, scene: Scene, world: World, moving: Solids, cameras: Cameras, images: NDArray[np.float32]
    ) -> None:
        """Measure the distances in m along all rays; those that hit nothing read ``far``.

        Args:
            scene: The static world.
            world: The same, as single rays meet it.
            moving: The moving solids.
            cameras: N viewers, all of whose numbers are finite; their pitches do not count.
            images: (N, C, A) m, written.
        """
        if self._sectors is not None:
            self._scan_sectors(self._sectors, scene, moving, cameras, images)
        if self._last - self._first < images.shape[1]:
            _cast_steep_rays(world, Solids(*moving), cameras, self._rings, self._first, self._last, images)

    def _scan_sectors(
        self,
        sectors: Sectors,
        scene: Scene,
        moving: Solids,
        cameras: Cameras,
        images: NDArray[np.float32],
    ) -> None:
        others, optics = pack_moving(moving), sectors.optics
        rings = self._last - self._first
        size = Size(rings, sectors.columns, optics.half_width, others.most_faces)
        workspace = scene.workspaces.of(scene.packed, size)
        _trace_sectors(
            cameras.eyes,
            cameras.yaws,
            cameras.viewers,
            cameras.far,
            sectors.number,
            optics,
            Rings(*(part[self._first : self._last] for part in self._rings)),
            others.numbers,
            others.indices,
            workspace.addresses,
            images,
            self._first,
        )


@kernel
def _aim_rings(
    elevations: NDArray[np.float64], levels: NDArray[np.float64], rises: NDArray[np.float64]
) -> None:
    for ring in range(elevations.shape[0]):
        levels[ring], rises[ring] = max(cosine(elevations[ring]), MIN_COSINE), sine(elevations[ring])


@kernel
def _trace_sectors(
    eyes: NDArray[np.float64],
    yaws: NDArray[np.float64],
    viewers: NDArray[np.int32],
    far: float,
    sectors: int,
    optics: Optics,
    rings: Rings,
    moving_numbers: NDArray[np.float64],
    moving_indices: NDArray[np.int64],
    workspace: Addresses,
    images: NDArray[np.float32],
    above: int,
) -> None:
    """Write the distances of some rings, of which the first is row ``above`` of the images."""
    parts = read_workspace(workspace)
    others = unpack_shapes(moving_numbers, moving_indices)
    blocks = unpack_blocks(parts.numbers, parts.indices, parts.float32s)
    solids = unpack_shapes(parts.numbers, parts.indices)
    scratch = scratch_in(parts)
    columns, azimuths = parts.met.shape[0] // rings.levels.shape[0], images.shape[2]
    buffer = hit_buffer_in(columns, parts.rays, parts.met, parts.strips)
    for image in range(yaws.shape[0]):
        for sector in range(sectors):
            first, last = sector * columns, min((sector + 1) * columns, azimuths)
            middle = yaws[image] + 360.0 * (first + (columns - 1) * 0.5) / azimuths
            camera = _camera_at(eyes[image], middle, columns, rings.levels.shape[0], optics, far)
            _aim_sector(buffer, rings, yaws[image], first, azimuths)
            fill(buffer, far, NOTHING)
            trace_world(blocks, solids, camera, False, scratch, buffer)
            trace_moving_solids(
                others, solids.boxes.shape[0], camera, viewers[image], scratch.outside, buffer
            )
            for ring in range(rings.levels.shape[0]):
                line, distance = images[image, above + ring, first:last], buffer.distance[ring * columns :]
                for column in range(last - first):
                    line[column] = distance[column]


@inlined_kernel
def _camera_at(
    eye: NDArray[np.float64], yaw: float, columns: int, rows: int, optics: Optics, far: float
) -> Camera:
    """Return the level camera that sees a sector."""
    return Camera(
        eye[0],
        eye[1],
        eye[2],
        sine(yaw),
        cosine(yaw),
        0.0,
        1.0,
        optics.scale,
        optics.curve,
        optics.scale_up,
        optics.spread,
        optics.level,
        columns,
        rows,
        optics.half_width,
        optics.half_height,
        np.sqrt(1.0 + optics.half_width * optics.half_width),
        np.sqrt(1.0 + optics.half_height * optics.half_height),
        far,
        MARGIN + optics.margin,
        MARGIN + optics.margin_up,
    )


@inlined_kernel
def _aim_sector(buffer: HitBuffer, rings: Rings, yaw: float, first: int, azimuths: int) -> None:
    """Set the directions of the rays of a sector that begins with a column of the panorama."""
    columns = buffer.width
    easts, norths = buffer.enter[:columns], buffer.leave[:columns]  # m per horizontal metre
    for column in range(columns):
        azimuth = yaw + 360.0 * (first + column) / azimuths
        easts[column], norths[column] = sine(azimuth), cosine(azimuth)
    for ring in range(rings.levels.shape[0]):
        start, end = ring * columns, (ring + 1) * columns
        east, up, north = buffer.east[start:end], buffer.up[start:end], buffer.north[start:end]
        level, rise = rings.levels[ring], rings.rises[ring]
        for column in range(columns):
            east[column] = easts[column] * level
        for column in range(columns):
            up[column] = rise
        for column in range(columns):
            north[column] = norths[column] * level


@kernel
def _cast_steep_rays(
    world: World,
    moving: Solids,
    cameras: Cameras,
    rings: Rings,
    first: int,
    last: int,
    images: NDArray[np.float32],
) -> None:
    """Write the distances of all rings but those from ``first`` up to, not including, ``last``."""
    _, channels, azimuths = images.shape
    for image in range(images.shape[0]):
        x, y, z = cameras.eyes[image, 0], cameras.eyes[image, 1], cameras.eyes[image, 2]
        for column in range(azimuths):
            azimuth = cameras.yaws[image] + 360.0 * column / azimuths
            east, north = sine(azimuth), cosine(azimuth)
            for ring in range(channels):
                if first <= ring < last:
                    continue
                level = rings.levels[ring]
                dx, dy, dz = east * level, rings.rises[ring], north * level
                ray = make_ray(world, x, y, z, dx, dy, dz)
                nearest = cast_ray(world, x, y, z, dx, dy, dz, cameras.far).distance
                nearest = nearest if nearest <= _to_edge(world, ray) else cameras.far
                images[image, ring, column] = _nearest(moving, cameras.viewers[image], ray, nearest)


@inlined_kernel
def _nearest(moving: Solids, viewer: int, ray: Ray, nearest: float) -> float:
    """Return the least of a distance in m and those where a ray enters moving solids not of its viewer."""
    for solid in range(moving.kind.shape[0]):
        if moving.owner[solid] != viewer and _passes(ray, moving, solid):
            start, end = moving.face_start[solid], moving.face_start[solid + 1]
            nearest = min(nearest, meet_faces(moving.faces, start, end, ray, nearest)[0])
    return nearest


@inlined_kernel
def _to_edge(world: World, ray: Ray) -> float:
    """Return where a ray leaves the map, m: what juts out beyond is invisible, as in images."""
    rows, columns = world.water.shape
    past_x = world.corner[0] + (columns * CELL if ray.dx > 0.0 else 0.0) - ray.x
    past_z = world.corner[1] + (rows * CELL if ray.dz > 0.0 else 0.0) - ray.z
    out_x = past_x / ray.dx if ray.dx != 0.0 else np.inf
    out_z = past_z / ray.dz if ray.dz != 0.0 else np.inf
    return float(min(out_x, out_z))


@inlined_kernel
def _passes(ray: Ray, moving: Solids, solid: int) -> bool:
    """Return whether a ray passes through the sphere around the box around a solid."""
    half_x = (moving.high[solid, 0] - moving.low[solid, 0]) * 0.5
    half_y = (moving.high[solid, 1] - moving.low[solid, 1]) * 0.5
    half_z = (moving.high[solid, 2] - moving.low[solid, 2]) * 0.5
    x, y = moving.low[solid, 0] + half_x - ray.x, moving.low[solid, 1] + half_y - ray.y
    z = moving.low[solid, 2] + half_z - ray.z
    along = max(0.0, x * ray.dx + y * ray.dy + z * ray.dz)
    away_x, away_y, away_z = x - along * ray.dx, y - along * ray.dy, z - along * ray.dz
    radius = half_x * half_x + half_y * half_y + half_z * half_z
    return bool(away_x * away_x + away_y * away_y + away_z * away_z <= radius * SPHERE)
