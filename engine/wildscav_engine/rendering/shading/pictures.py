"""Pictures: the colour of what each ray hit, in the light of the sun and the sky."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT
from wildscav_engine.geometry.terrain import water_at
from wildscav_engine.geometry.world import World
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.dynamic_objects import DynamicObjects
from wildscav_engine.rendering.shading.ambient_occlusion import REACH, unoccluded_share, write_depths
from wildscav_engine.rendering.shading.color_arithmetic import Color, Vector, dot
from wildscav_engine.rendering.shading.ground import cell_at, ground_color, ground_normal
from wildscav_engine.rendering.shading.light import is_roofed, lit, skylight, sun_shines
from wildscav_engine.rendering.shading.materials import Materials
from wildscav_engine.rendering.shading.moving_shadows import (
    Casters,
    allocate_casters,
    find_casters,
    is_shaded_by,
)
from wildscav_engine.rendering.shading.pixel_rays import (
    View,
    Ways,
    cosines_of,
    point_along,
    view_of,
    write_ways,
)
from wildscav_engine.rendering.shading.sky import BELOW, HORIZON, SUN_DIRECTION, ZENITH, sky
from wildscav_engine.rendering.shading.surfaces import textured
from wildscav_engine.rendering.shading.water import DEEP, MURK, water_color
from wildscav_engine.rendering.trace import WATER_HIT, Hits
from wildscav_engine.rendering.tracing.solids import Solids

LIFT, LIFT_SHARE = 0.004, 2e-4  # m, plus m per m of distance, off the surface: where a shadow ray starts

WIDE = 2.0  # pixels, within which nearby surfaces occlude, from where on four pixels share the result
NONE, HALF, ONE, MOST = np.float32(0.0), np.float32(0.5), np.float32(1.0), np.float32(255.0)
# The numbers of ``sky.haze`` in float32.
STEEPLY = np.float32(-2.5)
CLEAR_SKY = (np.float32(ZENITH[0]), np.float32(ZENITH[1]), np.float32(ZENITH[2]))
TO_HORIZON = tuple(np.float32(far - high) for far, high in zip(HORIZON, ZENITH, strict=True))
TO_BELOW = tuple(np.float32(low - far) for low, far in zip(BELOW, HORIZON, strict=True))
DEEP_WATER = (np.float32(DEEP[0]), np.float32(DEEP[1]), np.float32(DEEP[2]))
MURKINESS = np.float32(1.0 / MURK)


class ShadedScene(NamedTuple):
    """A map and its moving objects with everything that shading needs."""

    world: World
    materials: Materials
    moving: Solids  # S solids
    colors: NDArray[np.float64]  # (S, 3) of the moving solids
    casters: Casters  # those that cast shadows in the current image
    shadows: bool  # whether solids cast shadows


class Surface(NamedTuple):
    """The surface at a ray's hit."""

    base: Color  # unlit
    normal: Vector
    place: Vector  # m


def shade(
    world: World,
    materials: Materials,
    moving: DynamicObjects,
    cameras: Cameras,
    hits: Hits,
    images: NDArray[np.uint8],
    *,
    shadows: bool,
) -> None:
    """Shade the hits of rays.

    Args:
        world: The static world.
        materials: Its appearance.
        moving: The moving objects in it.
        cameras: N cameras.
        hits: Of N images, water included.
        images: (N, H, W, 3) red, green, blue, written.
        shadows: Whether solids cast shadows.
    """
    height, width = images.shape[1:3]
    casters = allocate_casters(len(moving.kind))
    scene = ShadedScene(world, materials, moving.solids, moving.color, casters, shadows)
    cosines = cosines_of(cameras.half_width, height, width)
    _shade(scene, cameras, hits, cosines, np.empty_like(cosines), np.empty((11, width), np.float32), images)


class RowOfPixels(NamedTuple):
    """What is computed for one row of pixels, (W,) each."""

    ways: Ways
    red: NDArray[np.float32]  # colours without haze, 0-255
    green: NDArray[np.float32]
    blue: NDArray[np.float32]
    fog: NDArray[np.float32]  # share of the haze, or of murky water, in the final colour
    ambient: NDArray[np.float32]  # light on surfaces from the sky, as far as nearby surfaces leave it
    ambient_above: NDArray[np.float32]  # the same in the row above
    level: NDArray[np.float32]  # how near rays are to the horizon, 0-1
    spare: NDArray[np.float32]  # scratch buffer


@inlined_kernel
def _row_in(buffer: NDArray[np.float32], row: int) -> RowOfPixels:
    ways = Ways(buffer[0], buffer[1], buffer[2])
    this, above = buffer[7 + (row & 1)], buffer[8 - (row & 1)]
    return RowOfPixels(ways, buffer[3], buffer[4], buffer[5], buffer[6], this, above, buffer[9], buffer[10])


@kernel
def _shade(
    scene: ShadedScene,
    cameras: Cameras,
    hits: Hits,
    cosines: NDArray[np.float32],
    depths: NDArray[np.float32],
    buffer: NDArray[np.float32],
    images: NDArray[np.uint8],
) -> None:
    """Write pictures.

    ``cosines`` (H, W) are those of the angles between the rays and the view axis; ``depths`` (H, W) and
    ``buffer`` (11, W) are scratch buffers.
    """
    for image in range(images.shape[0]):
        view = view_of(cameras, image, images.shape[1], images.shape[2])
        count = find_casters(scene.moving, view.eye, scene.casters) if scene.shadows else 0
        write_depths(hits.distance[image], cosines, depths)
        is_under_water = water_at(scene.world, view.eye[0], view.eye[2]) > view.eye[1]
        hit = Hits(hits.distance[image], hits.solid[image], hits.face[image])
        for row in range(view.height):
            pixels = _row_in(buffer, row)
            write_ways(view, row, cosines[row], pixels.ways)
            _color_row(scene, view, hit, depths, row, count, pixels)
            if is_under_water:
                _write_murk(hit.distance[row], pixels, images[image, row])
            else:
                _write_hazy(hit.distance[row], hit.solid[row], cameras.far, pixels, images[image, row])


@inlined_kernel
def _write_hazy(
    distances: NDArray[np.float32],
    solids: NDArray[np.int32],
    far: float,
    pixels: RowOfPixels,
    colors: NDArray[np.uint8],
) -> None:
    """Write (W, 3) the colours of a row, with the haze of the open air."""
    # Short loops over few arrays, which the compiler can vectorize.
    nearness, up, level = np.float32(1.0 / far), pixels.ways.up, pixels.level
    for column in range(colors.shape[0]):
        part = min(ONE, distances[column] * nearness)
        pixels.fog[column] = part * part if solids[column] != NOTHING_HIT else NONE
    for column in range(colors.shape[0]):
        rest = ONE - max(NONE, up[column])
        level[column] = rest * rest * rest * rest
    # The eastward and northward parts of the rays are not needed any more.
    red, green, blue = pixels.ways.east, pixels.ways.north, pixels.spare
    _blend_haze(pixels.red, level, up, pixels.fog, 0, red)
    _blend_haze(pixels.green, level, up, pixels.fog, 1, green)
    _blend_haze(pixels.blue, level, up, pixels.fog, 2, blue)
    for column in range(colors.shape[0]):
        colors[column, 0] = np.int32(red[column])
        colors[column, 1] = np.int32(green[column])
        colors[column, 2] = np.int32(blue[column])


@inlined_kernel
def _blend_haze(
    own: NDArray[np.float32],
    level: NDArray[np.float32],
    up: NDArray[np.float32],
    fog: NDArray[np.float32],
    channel: int,
    blended: NDArray[np.float32],
) -> None:
    """Blend one channel of a row with the haze in each direction; it is ``sky.haze`` without branches."""
    high, to_horizon, to_below = CLEAR_SKY[channel], TO_HORIZON[channel], TO_BELOW[channel]
    for column in range(own.shape[0]):
        low = min(ONE, max(NONE, STEEPLY * up[column]))
        haze = high + to_horizon * level[column] + to_below * low
        blended[column] = _rounded(own[column], haze, fog[column])


@inlined_kernel
def _write_murk(distances: NDArray[np.float32], pixels: RowOfPixels, colors: NDArray[np.uint8]) -> None:
    """Write (W, 3) the colours of a row, as seen through water."""
    for column in range(colors.shape[0]):
        share = min(ONE, distances[column] * MURKINESS)
        colors[column, 0] = np.int32(_rounded(pixels.red[column], DEEP_WATER[0], share))
        colors[column, 1] = np.int32(_rounded(pixels.green[column], DEEP_WATER[1], share))
        colors[column, 2] = np.int32(_rounded(pixels.blue[column], DEEP_WATER[2], share))


@inlined_kernel
def _rounded(own: np.float32, other: np.float32, share: np.float32) -> np.float32:
    """Return the blend of two brightnesses, by the share of the other, to be rounded down, 0-255."""
    return min(MOST, max(NONE, own + (other - own) * share + HALF))


@inlined_kernel
def _color_row(
    scene: ShadedScene,
    view: View,
    hit: Hits,
    depths: NDArray[np.float32],
    row: int,
    count: int,
    pixels: RowOfPixels,
) -> None:
    """Write the colours of a row without haze, given what its rays hit in ``hit``, all (H, W)."""
    for column in range(view.width):
        ways = pixels.ways
        direction = (float(ways.east[column]), float(ways.up[column]), float(ways.north[column]))
        solid = hit.solid[row, column]
        if solid == NOTHING_HIT:
            color = sky(direction, scene.materials.clouds)
        else:
            distance = float(hit.distance[row, column])
            surface = _surface(scene, solid, hit.face[row, column], view, direction, distance)
            # Slightly off the surface.
            in_air = point_along(surface.place, surface.normal, LIFT + LIFT_SHARE * distance)
            sun = _sunlight(scene, surface.normal, in_air, count)
            ambient = _ambient(
                scene, hit, depths, row, column, view, distance, surface.normal, in_air, pixels
            )
            if solid == WATER_HIT:
                color = _water(scene, surface, direction, distance, view, sun, ambient)
            else:
                color = lit(surface.base, surface.normal, sun, ambient)
        pixels.red[column], pixels.green[column], pixels.blue[column] = color


@inlined_kernel
def _ambient(
    scene: ShadedScene,
    hit: Hits,
    depths: NDArray[np.float32],
    row: int,
    column: int,
    view: View,
    distance: float,
    normal: Vector,
    place: Vector,
    pixels: RowOfPixels,
) -> float:
    """Return the ambient light on a surface, at a place slightly off it, and note it for the pixels beside.

    It changes little from pixel to pixel, so four pixels share it if they show the same surface.
    """
    is_wide = WIDE * distance * view.pixel <= REACH
    if is_wide and column & 1 and _is_same(hit, row, column, row, column - 1):
        ambient = float(pixels.ambient[column - 1])
    elif is_wide and row & 1 and _is_same(hit, row, column, row - 1, column):
        ambient = float(pixels.ambient_above[column])
    else:
        ambient = skylight(normal, is_roofed(scene.materials.upwards, scene.world, place))
        if hit.solid[row, column] != WATER_HIT:
            ambient *= unoccluded_share(depths, row, column, view, distance, normal)
    pixels.ambient[column] = ambient
    return ambient


@inlined_kernel
def _is_same(hit: Hits, row: int, column: int, other_row: int, other_column: int) -> bool:
    """Return whether two pixels show the same face of a solid, or both the ground."""
    solid = hit.solid[row, column]
    is_alike = hit.face[row, column] == hit.face[other_row, other_column] or solid == TERRAIN_HIT
    return bool(solid == hit.solid[other_row, other_column] and is_alike)


@inlined_kernel
def _water(
    scene: ShadedScene,
    surface: Surface,
    direction: Vector,
    distance: float,
    view: View,
    sun: float,
    ambient: float,
) -> Color:
    """Return the colour of water in its light."""
    pixel, materials = _footprint(view, direction, distance, surface.normal), scene.materials
    return water_color(
        scene.world, materials.ground, materials.clouds, surface.place, direction, sun, ambient, pixel
    )


@inlined_kernel
def _surface(
    scene: ShadedScene, solid: int, face: int, view: View, direction: Vector, distance: float
) -> Surface:
    place = point_along(view.eye, direction, distance)
    statics = scene.world.solid_kind.shape[0]
    if solid == TERRAIN_HIT:
        cell = cell_at(scene.world, place[0], place[2])
        normal = ground_normal(scene.materials.ground, cell)
        pixel = _footprint(view, direction, distance, normal)
        return Surface(ground_color(scene.materials.ground, cell, place, pixel), normal, place)
    if solid == WATER_HIT:
        return Surface((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), place)
    if solid >= statics:
        faces, colors, moving_solid = scene.moving.faces, scene.colors, solid - statics
        base = (colors[moving_solid, 0], colors[moving_solid, 1], colors[moving_solid, 2])
        return Surface(base, (faces[face, 0], faces[face, 1], faces[face, 2]), place)
    walls, colors, axes = scene.world.faces, scene.materials.color, scene.materials.axis
    normal = (walls[face, 0], walls[face, 1], walls[face, 2])
    base = (colors[solid, 0], colors[solid, 1], colors[solid, 2])
    axis = (axes[solid, 0], 0.0, axes[solid, 1])
    pixel = _footprint(view, direction, distance, normal)
    return Surface(textured(scene.world.solid_kind[solid], base, normal, place, axis, pixel), normal, place)


@inlined_kernel
def _footprint(view: View, direction: Vector, distance: float, normal: Vector) -> float:
    """Return the size in m of a pixel on a surface."""
    return view.pixel * distance / max(0.2, -dot(direction, normal))


@inlined_kernel
def _sunlight(scene: ShadedScene, normal: Vector, place: Vector, count: int) -> float:
    """Return the share of the sun's light that reaches a surface, 0 or 1, at a place slightly off it."""
    if dot(normal, SUN_DIRECTION) <= 0.0:
        return 0.0
    if not scene.shadows:
        return 1.0
    if is_shaded_by(scene.moving, scene.casters, count, place):
        return 0.0
    return 1.0 if sun_shines(scene.materials.to_sun, scene.world, place) else 0.0
