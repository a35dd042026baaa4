"""Ray tracing for panoramas: how far the rays of a LIDAR go.

Most rings are traced like images, sector by sector, as cameras see them that look around on the level. Their
rays are at equal angles, and the tangents of equal angles are not at equal distances: on the image of a
pinhole camera, columns of rays are farther apart at the sides; rings are farther apart at the top and bottom,
and rise or fall towards the sides. So a sector has optics of its own, see ``Camera``. Rings that point
steeply up or down would need images of endless height. Their rays are short, so they are cast one by one.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.rays import Ray, intersect_faces, make_ray, raycast
from wildscav_engine.geometry.world import CELL, World
from wildscav_engine.parallel.turns import ALONE, Turns
from wildscav_engine.rendering.cameras import TAKEN_ALREADY, Cameras, item_at
from wildscav_engine.rendering.dynamic_objects import ObjectSets
from wildscav_engine.rendering.trace import (
    Scene,
    Scenes,
    flatten_views,
    read_views,
    shapes_of_match,
    trace_moving,
    trace_static,
    workspace_of,
)
from wildscav_engine.rendering.tracing.frustum import Optics, camera_at
from wildscav_engine.rendering.tracing.hit_buffer import NOTHING, HitBuffer, fill, hit_buffer_in
from wildscav_engine.rendering.tracing.solids import Solids
from wildscav_engine.rendering.tracing.workspace import Size

WIDEST = 36.0  # degrees of one sector; wide ones select more rays in vain, more of them repeat more work
# With few rings, wide sectors are faster: repeated work would take longer than rays in vain. Their optics do
# not fit fewer or more azimuths.
FEW_RINGS, FEW_AZIMUTHS, WIDEST_OF_FEW = 3, range(32, 200), 90.0
BESIDE = (
    1.0  # columns that a sector is wider than its rays on either side, so that clear misses count as such
)
ALOFT = 1e-6  # tangents that it is higher, to allow for rounding
SINGLE = 50.0  # columns or rows per radian where there is only one, and any number would do
STEEPEST = 80.0  # degrees up and down of the rings that are traced like images
MIN_COSINE = 1e-12  # rays straight up and down lean by this little
SPHERE = 1.0 + 1e-9  # by which the squares of radii are enlarged to allow for rounding


class Sectors(NamedTuple):
    """A panorama in S sectors of N columns; the last may reach into the first."""

    number: int  # S
    columns: int  # N
    optics: Optics


def divide(azimuths: int, elevations: NDArray[np.float64]) -> Sectors:
    """Divide a panorama into sectors of equal size.

    Args:
        elevations: (C,) degrees above the horizon of its rings, at equal distances, the highest first; none
            points straight up or down.
    """
    are_few = len(elevations) <= FEW_RINGS and azimuths in FEW_AZIMUTHS
    widest = WIDEST_OF_FEW if are_few else WIDEST
    number = -(-azimuths // max(1, int(azimuths * widest / 360.0)))
    columns = -(-azimuths // number)
    angle = 2.0 * np.pi / azimuths
    places = np.arange(columns) - (columns - 1) / 2.0
    right = np.tan(places * angle)
    scale, curve = _scale_of(places, right)
    margin = np.abs(scale * right + curve * right**3 - places).max()
    side = np.cos(places[-1] * angle)
    half_width = right[-1] + BESIDE / (scale + 3.0 * curve * right[-1] ** 2)
    scale_up, spread, level, margin_up = _rows_of(np.radians(elevations), float(side))
    half_height = np.tan(np.radians(np.abs(elevations).max())) / side + ALOFT
    optics = Optics(
        float(scale),
        float(curve),
        scale_up,
        spread,
        level,
        float(half_width),
        float(half_height),
        float(margin),
        margin_up,
    )
    return Sectors(number, columns, optics)


def _scale_of(places: NDArray[np.floating], right: NDArray[np.floating]) -> tuple[float, float]:
    """Return the scale and the curve that fit columns best, given their places and their tangents."""
    if len(places) == 1:
        return SINGLE, 0.0
    if len(places) == 2:
        return float(places[1] / right[1]), 0.0
    scale, curve = np.linalg.lstsq(np.stack([right, right**3], axis=1), places, rcond=None)[0]
    return float(scale), float(curve)


def _rows_of(elevations: NDArray[np.float64], side: float) -> tuple[float, float, float, float]:
    """Return the scale upwards, the spread, the level and the margin upwards, given elevations in radians.

    ``side`` is the cosine of the angle between the middle and the side of the sector.
    """
    span = float(elevations[0] - elevations[-1])
    per_radian = (len(elevations) - 1) / span if span > 0.0 else SINGLE
    # Over the tangent upwards on the image, the angle is 1 for a level ray, and least for the steepest at the
    # side.
    steepest = float(np.abs(elevations).max())
    least = side * steepest / np.tan(steepest) if steepest > 0.0 else side
    scale_up, spread = per_radian * (1.0 + least) / 2.0, per_radian * (1.0 - least) / 2.0
    margin = 0.0 if span > 0.0 else len(elevations) - 1.0  # All rings may be at the same place.
    return float(scale_up), float(spread), float(elevations[0] * per_radian) + 0.5, margin


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
        self._level_rings = Rings(*(part[self._first : self._last] for part in self._rings))
        self._sectors: Sectors | None = None
        if self._first < self._last:
            self._sectors = divide(azimuths, elevations[self._first : self._last])

    @property
    def is_steep(self) -> bool:
        """Whether it has rings that are cast ray by ray."""
        return self._last - self._first < len(self._rings.levels)

    def trace(
        self,
        scenes: Scene | Scenes,
        objects: ObjectSets,
        matches: NDArray[np.int64],
        cameras: Cameras,
        images: NDArray[np.float32],
        turns: Turns = ALONE,
    ) -> None:
        """Measure the distances in m along all rays that are not steep; those that hit nothing read ``far``.

        All numbers of the cameras must be finite; their pitches do not count. The images are (N, C, A). For
        the rest, see ``images.trace_images``.
        """
        sectors = self._sectors
        if sectors is None:
            return
        number, columns, optics = sectors
        size = Size(self._last - self._first, columns, optics.half_width, objects.most_faces)
        views = flatten_views(scenes, objects, matches, cameras, turns, size)
        _trace_sectors(number, optics, self._level_rings, self._first, images, *views)

    def cast_steep_rays(
        self, world: World, moving: Solids, cameras: Cameras, images: NDArray[np.float32]
    ) -> None:
        """Measure the distances along all other rays, with the same arguments but one world for all."""
        _cast_steep_rays(world, moving, cameras, self._rings, self._first, self._last, images)


@kernel
def _aim_rings(
    elevations: NDArray[np.float64], levels: NDArray[np.float64], rises: NDArray[np.float64]
) -> None:
    for ring in range(elevations.shape[0]):
        levels[ring], rises[ring] = max(cosine(elevations[ring]), MIN_COSINE), sine(elevations[ring])


@kernel
def _trace_sectors(
    sectors: int, optics: Optics, rings: Rings, above: int, images: NDArray[np.float32], *views: Any
) -> None:
    """Write the distances of some rings, of which the first is row ``above`` of the images."""
    cameras, matches, turns = read_views(views)
    count, _, azimuths = images.shape
    for turn in range(count):
        image = item_at(turns, turn)
        if image == TAKEN_ALREADY:
            continue
        yaw = cameras.yaws[image]
        parts, others = workspace_of(matches, image), shapes_of_match(matches, image)
        columns = parts.image.met.shape[0] // rings.levels.shape[0]
        buffer = hit_buffer_in(columns, parts.image)
        for sector in range(sectors):
            first, last = sector * columns, min((sector + 1) * columns, azimuths)
            middle = yaw + 360.0 * (first + (columns - 1) * 0.5) / azimuths
            eye, count_of_rings = cameras.eyes[image], rings.levels.shape[0]
            camera = camera_at(eye, middle, 0.0, optics, columns, count_of_rings, cameras.far)
            _aim_sector(buffer, rings, yaw, first, azimuths)
            fill(buffer, cameras.far, NOTHING)
            trace_static(parts, camera, False, buffer)
            trace_moving(parts, others, camera, cameras.viewers[image], buffer)
            for ring in range(rings.levels.shape[0]):
                line, distance = images[image, above + ring, first:last], buffer.distance[ring * columns :]
                for column in range(last - first):
                    line[column] = distance[column]


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
                nearest = raycast(world, x, y, z, dx, dy, dz, cameras.far).distance
                nearest = nearest if nearest <= _to_edge(world, ray) else cameras.far
                images[image, ring, column] = _nearest(moving, cameras.viewers[image], ray, nearest)


@inlined_kernel
def _nearest(moving: Solids, viewer: int, ray: Ray, nearest: float) -> float:
    """Return the least of a distance in m and those where a ray enters moving solids not of its viewer."""
    for solid in range(moving.kind.shape[0]):
        if moving.owner[solid] != viewer and _passes(ray, moving, solid):
            start, end = moving.face_start[solid], moving.face_start[solid + 1]
            nearest = min(nearest, intersect_faces(moving.faces, start, end, ray, nearest)[0])
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
