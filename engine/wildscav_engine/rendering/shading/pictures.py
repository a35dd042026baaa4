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
from wildscav_engine.rendering.shading.ambient_occlusion import unoccluded_share
from wildscav_engine.rendering.shading.color_arithmetic import Color, Vector, clipped, dot, mixed
from wildscav_engine.rendering.shading.ground import ground_color, ground_normal
from wildscav_engine.rendering.shading.light import (
    find_shadow_casters,
    is_roofed,
    is_shaded_by,
    lit,
    skylight,
    sun_is_clear,
)
from wildscav_engine.rendering.shading.materials import Materials
from wildscav_engine.rendering.shading.pixel_rays import View, point_along, view_of, write_directions
from wildscav_engine.rendering.shading.sky import SUN_DIRECTION, haze, sky
from wildscav_engine.rendering.shading.surfaces import textured
from wildscav_engine.rendering.shading.water import DEEP, MURK, water_color
from wildscav_engine.rendering.trace import WATER_HIT, Hits
from wildscav_engine.rendering.tracing.solids import Solids

LIFT, LIFT_SHARE = 0.004, 2e-4  # m, plus m per m of distance, off the surface: where a shadow ray starts


class ShadedScene(NamedTuple):
    """A map and its moving objects with everything that shading needs."""

    world: World
    materials: Materials
    moving: Solids  # S solids
    colors: NDArray[np.float64]  # (S, 3) of the moving solids
    shadows: bool  # whether solids cast shadows


class Surface(NamedTuple):
    """The surface at a ray's hit."""

    base: Color  # unlit
    normal: Vector
    place: Vector  # m
    in_air: Vector  # m, slightly off the surface


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
    scene = ShadedScene(world, materials, moving.solids, moving.color, shadows)
    casters, directions = np.empty(len(moving.kind), np.int64), np.empty((*images.shape[1:3], 3))
    _shade(scene, cameras, hits, casters, directions, images)


@kernel
def _shade(
    scene: ShadedScene,
    cameras: Cameras,
    hits: Hits,
    casters: NDArray[np.int64],
    directions: NDArray[np.float64],
    images: NDArray[np.uint8],
) -> None:
    """Write pictures.

    Scratch buffers: ``casters`` (S,) for the moving solids that cast shadows, and ``directions`` (H, W, 3)
    for the unit vectors of the rays.
    """
    for image in range(images.shape[0]):
        count = find_shadow_casters(scene.moving, cameras.eyes[image], casters) if scene.shadows else 0
        view = view_of(cameras, image, images.shape[1], images.shape[2])
        write_directions(view, directions)
        under_water = water_at(scene.world, view.eye[0], view.eye[2]) > view.eye[1]
        for row in range(images.shape[1]):
            for column in range(images.shape[2]):
                direction = (
                    directions[row, column, 0],
                    directions[row, column, 1],
                    directions[row, column, 2],
                )
                color = _color_of_pixel(scene, view, hits, image, row, column, directions, casters, count)
                distance = float(hits.distance[image, row, column])
                if under_water:
                    color = mixed(color, DEEP, min(1.0, distance / MURK))
                elif hits.solid[image, row, column] != NOTHING_HIT:
                    part = min(1.0, distance / cameras.far)
                    color = mixed(color, haze(direction), part * part)
                for channel in range(3):
                    images[image, row, column, channel] = int(clipped(color[channel] + 0.5, 0.0, 255.0))


@inlined_kernel
def _color_of_pixel(
    scene: ShadedScene,
    view: View,
    hits: Hits,
    image: int,
    row: int,
    column: int,
    directions: NDArray[np.float64],
    casters: NDArray[np.int64],
    count: int,
) -> Color:
    """Return the colour of a pixel without haze."""
    solid = hits.solid[image, row, column]
    direction = (directions[row, column, 0], directions[row, column, 1], directions[row, column, 2])
    if solid == NOTHING_HIT:
        return sky(direction)
    distance = float(hits.distance[image, row, column])
    face = hits.face[image, row, column]
    surface = _surface(scene, solid, face, view, direction, distance)
    sun = _sunlight(scene, surface, casters, count)
    ambient = skylight(surface.normal, is_roofed(scene.world, surface.in_air))
    if solid == WATER_HIT:
        pixel = _footprint(view, direction, distance, surface.normal)
        appearance = scene.materials.ground
        return water_color(scene.world, appearance, surface.place, direction, sun, ambient, pixel)
    ambient *= unoccluded_share(hits, image, row, column, view, directions, surface.place, surface.normal)
    return lit(surface.base, surface.normal, sun, ambient)


@inlined_kernel
def _surface(
    scene: ShadedScene, solid: int, face: int, view: View, direction: Vector, distance: float
) -> Surface:
    place = point_along(view.eye, direction, distance)
    normal = _normal(scene, solid, face, place)
    pixel = _footprint(view, direction, distance, normal)
    statics = scene.world.solid_kind.shape[0]
    base = (0.0, 0.0, 0.0)
    if solid == TERRAIN_HIT:
        base = ground_color(scene.world, scene.materials.ground, place, pixel)
    elif solid >= statics:
        colors = scene.colors
        moving_solid = solid - statics
        base = (colors[moving_solid, 0], colors[moving_solid, 1], colors[moving_solid, 2])
    elif solid >= 0:
        colors, axes = scene.materials.color, scene.materials.axis
        base = (colors[solid, 0], colors[solid, 1], colors[solid, 2])
        axis = (axes[solid, 0], 0.0, axes[solid, 1])
        base = textured(scene.world.solid_kind[solid], base, normal, place, axis, pixel)
    in_air = point_along(place, normal, LIFT + LIFT_SHARE * distance)
    return Surface(base, normal, place, in_air)


@inlined_kernel
def _normal(scene: ShadedScene, solid: int, face: int, place: Vector) -> Vector:
    statics = scene.world.solid_kind.shape[0]
    if solid == TERRAIN_HIT:
        return ground_normal(scene.world, scene.materials.ground, place)
    if solid == WATER_HIT:
        return 0.0, 1.0, 0.0
    if solid >= statics:
        faces = scene.moving.faces
        return faces[face, 0], faces[face, 1], faces[face, 2]
    walls = scene.world.faces
    return walls[face, 0], walls[face, 1], walls[face, 2]


@inlined_kernel
def _footprint(view: View, direction: Vector, distance: float, normal: Vector) -> float:
    """Return the size in m of a pixel on a surface."""
    return view.pixel * distance / max(0.2, -dot(direction, normal))


@inlined_kernel
def _sunlight(scene: ShadedScene, surface: Surface, casters: NDArray[np.int64], count: int) -> float:
    """Return the share of the sun's light that reaches a surface, 0 or 1."""
    if dot(surface.normal, SUN_DIRECTION) <= 0.0:
        return 0.0
    if not scene.shadows:
        return 1.0
    if is_shaded_by(scene.moving, casters, count, surface.in_air):
        return 0.0
    return 1.0 if sun_is_clear(scene.world, surface.in_air) else 0.0
