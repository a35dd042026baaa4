"""Pictures: the colour of what each ray met, in the light of the sun and the sky."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT
from wildscav_engine.geometry.terrain import water_at
from wildscav_engine.geometry.world import World
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.dynamic_objects import DynamicObjects
from wildscav_engine.rendering.shading.color_sums import Color, Vector, clipped, dot, mixed
from wildscav_engine.rendering.shading.creases import creased
from wildscav_engine.rendering.shading.ground import ground_color, ground_normal
from wildscav_engine.rendering.shading.light import find_near, is_roofed, lit, shades, skylight, sun_is_clear
from wildscav_engine.rendering.shading.materials import Materials
from wildscav_engine.rendering.shading.pixel_rays import View, place_on, view_of, write_ways
from wildscav_engine.rendering.shading.sky import SUN_WAY, haze, sky
from wildscav_engine.rendering.shading.surfaces import textured
from wildscav_engine.rendering.shading.water import DEEP, MURK, water_color
from wildscav_engine.rendering.trace import WATER_HIT, Hits
from wildscav_engine.rendering.tracing.solids import Solids

LIFT, LIFT_SHARE = 0.004, 2e-4  # m, and m per m of distance, how far off its surface a ray of light starts


class Lit(NamedTuple):
    """A map and what moves in it, as pictures show them."""

    world: World
    materials: Materials
    moving: Solids  # S solids
    colors: NDArray[np.float64]  # (S, 3) of what moves
    shadows: bool  # whether things cast shadows


class Surface(NamedTuple):
    """What a ray met."""

    base: Color  # unlit
    normal: Vector
    place: Vector  # m
    in_air: Vector  # m, just off the surface


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
    """Make pictures of what rays met.

    Args:
        world: The static world.
        materials: What it looks like.
        moving: What moves in it.
        cameras: N cameras.
        hits: Of N images, water included.
        images: (N, H, W, 3) red, green, blue, written.
        shadows: Whether things cast shadows.
    """
    subject = Lit(world, materials, moving.solids, moving.color, shadows)
    near, ways = np.empty(len(moving.kind), np.int64), np.empty((*images.shape[1:3], 3))
    _shade(subject, cameras, hits, near, ways, images)


@kernel
def _shade(
    subject: Lit,
    cameras: Cameras,
    hits: Hits,
    near: NDArray[np.int64],
    ways: NDArray[np.float64],
    images: NDArray[np.uint8],
) -> None:
    """Write pictures.

    There is (S,) room in ``near`` for those moving solids that cast shadows, and (H, W, 3) in ``ways`` for
    the unit vectors of the rays.
    """
    for image in range(images.shape[0]):
        count = find_near(subject.moving, cameras.eyes[image], near) if subject.shadows else 0
        view = view_of(cameras, image, images.shape[1], images.shape[2])
        write_ways(view, ways)
        under_water = water_at(subject.world, view.eye[0], view.eye[2]) > view.eye[1]
        for row in range(images.shape[1]):
            for column in range(images.shape[2]):
                way = (ways[row, column, 0], ways[row, column, 1], ways[row, column, 2])
                color = _seen(subject, view, hits, image, row, column, ways, near, count)
                distance = float(hits.distance[image, row, column])
                if under_water:
                    color = mixed(color, DEEP, min(1.0, distance / MURK))
                elif hits.solid[image, row, column] != NOTHING_HIT:
                    part = min(1.0, distance / cameras.far)
                    color = mixed(color, haze(way), part * part)
                for channel in range(3):
                    images[image, row, column, channel] = int(clipped(color[channel] + 0.5, 0.0, 255.0))


@inlined_kernel
def _seen(
    subject: Lit,
    view: View,
    hits: Hits,
    image: int,
    row: int,
    column: int,
    ways: NDArray[np.float64],
    near: NDArray[np.int64],
    count: int,
) -> Color:
    """Return the colour that a ray meets, as if there were no haze."""
    solid = hits.solid[image, row, column]
    way = (ways[row, column, 0], ways[row, column, 1], ways[row, column, 2])
    if solid == NOTHING_HIT:
        return sky(way)
    distance = float(hits.distance[image, row, column])
    face = hits.face[image, row, column]
    surface = _surface(subject, solid, face, view, way, distance)
    sun = _sunshine(subject, surface, near, count)
    around = skylight(surface.normal, is_roofed(subject.world, surface.in_air))
    if solid == WATER_HIT:
        pixel = _footprint(view, way, distance, surface.normal)
        look = subject.materials.ground
        return water_color(subject.world, look, surface.place, way, sun, around, pixel)
    around *= creased(hits, image, row, column, view, ways, surface.place, surface.normal)
    return lit(surface.base, surface.normal, sun, around)


@inlined_kernel
def _surface(subject: Lit, solid: int, face: int, view: View, way: Vector, distance: float) -> Surface:
    place = place_on(view.eye, way, distance)
    normal = _normal(subject, solid, face, place)
    pixel = _footprint(view, way, distance, normal)
    statics = subject.world.solid_kind.shape[0]
    base = (0.0, 0.0, 0.0)
    if solid == TERRAIN_HIT:
        base = ground_color(subject.world, subject.materials.ground, place, pixel)
    elif solid >= statics:
        colors = subject.colors
        thing = solid - statics
        base = (colors[thing, 0], colors[thing, 1], colors[thing, 2])
    elif solid >= 0:
        colors, axes = subject.materials.color, subject.materials.axis
        base = (colors[solid, 0], colors[solid, 1], colors[solid, 2])
        axis = (axes[solid, 0], 0.0, axes[solid, 1])
        base = textured(subject.world.solid_kind[solid], base, normal, place, axis, pixel)
    in_air = place_on(place, normal, LIFT + LIFT_SHARE * distance)
    return Surface(base, normal, place, in_air)


@inlined_kernel
def _normal(subject: Lit, solid: int, face: int, place: Vector) -> Vector:
    statics = subject.world.solid_kind.shape[0]
    if solid == TERRAIN_HIT:
        return ground_normal(subject.world, subject.materials.ground, place)
    if solid == WATER_HIT:
        return 0.0, 1.0, 0.0
    if solid >= statics:
        faces = subject.moving.faces
        return faces[face, 0], faces[face, 1], faces[face, 2]
    walls = subject.world.faces
    return walls[face, 0], walls[face, 1], walls[face, 2]


@inlined_kernel
def _footprint(view: View, way: Vector, distance: float, normal: Vector) -> float:
    """Return how large a pixel is on a surface, m."""
    return view.pixel * distance / max(0.2, -dot(way, normal))


@inlined_kernel
def _sunshine(subject: Lit, surface: Surface, near: NDArray[np.int64], count: int) -> float:
    """Return the share of the sun's light that comes to a surface, 0 or 1."""
    if dot(surface.normal, SUN_WAY) <= 0.0:
        return 0.0
    if not subject.shadows:
        return 1.0
    if shades(subject.moving, near, count, surface.in_air):
        return 0.0
    return 1.0 if sun_is_clear(subject.world, surface.in_air) else 0.0
