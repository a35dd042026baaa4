"""Shading one picture: the colour of what each ray hit, in the light of the sun and the sky."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT
from wildscav_engine.geometry.terrain import water_at
from wildscav_engine.geometry.world import World
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.hits import WATER_HIT, Hits
from wildscav_engine.rendering.shading.ambient_light import place_of, write_ambient, write_places_off
from wildscav_engine.rendering.shading.ambient_occlusion import Around, write_depths
from wildscav_engine.rendering.shading.color_arithmetic import Color, Vector
from wildscav_engine.rendering.shading.columns import write_columns
from wildscav_engine.rendering.shading.ground_along_rows import write_ground
from wildscav_engine.rendering.shading.haze import write_fog, write_hazy, write_murky
from wildscav_engine.rendering.shading.light import DIRECT, SKY_COLOR, SUN_COLOR, sun_shines
from wildscav_engine.rendering.shading.materials import Materials
from wildscav_engine.rendering.shading.moving_shadows import Casters, find_casters, is_shaded_by
from wildscav_engine.rendering.shading.pieces import find_pieces
from wildscav_engine.rendering.shading.pixel_rays import (
    View,
    Ways,
    footprint,
    point_along,
    view_of,
    way_of,
    write_ways,
)
from wildscav_engine.rendering.shading.pixel_rows import Channels, Normals, Places, RowOfPixels, row_in
from wildscav_engine.rendering.shading.sky import SUN_DIRECTION
from wildscav_engine.rendering.shading.sky_along_rows import write_sky
from wildscav_engine.rendering.shading.surfaces import textured
from wildscav_engine.rendering.shading.surfaces_along_rows import has_spots, write_spotted
from wildscav_engine.rendering.shading.texture_scratch import AT_ONCE, TextureScratch
from wildscav_engine.rendering.shading.water import water_color
from wildscav_engine.rendering.tracing.solids import Solids

NONE = np.float32(0.0)
SUN_32 = tuple(np.float32(part) for part in SUN_COLOR)
SKY_32 = tuple(np.float32(part) for part in SKY_COLOR)


class ShadedScene(NamedTuple):
    """A map and its moving objects with everything that shading needs."""

    world: World
    materials: Materials
    moving: Solids  # S solids
    colors: NDArray[np.float64]  # (S, 3) of the moving solids
    casters: Casters  # those that cast shadows in the current image
    shadows: bool  # whether solids cast shadows


class Canvas(NamedTuple):
    """Scratch buffers for shading an image."""

    depths: NDArray[np.float32]  # (H, W) m
    rows: NDArray[np.float32]  # as of ``allocate_rows``
    pieces: NDArray[np.int32]  # (W + 1,)
    around: Around
    texture: TextureScratch


@kernel
def shade(
    scene: ShadedScene,
    cameras: Cameras,
    number: int,
    hit: Hits,
    canvas: Canvas,
    cosines: NDArray[np.float32],
    image: NDArray[np.uint8],
) -> None:
    """Shade the hits of the rays of one image.

    Args:
        hit: What its rays hit, water included, (H, W) each.
        cosines: (H, W) of the angles between the rays and the view axis.
        image: (H, W, 3) red, green, blue, written.
    """
    view = view_of(cameras, number, image.shape[0], image.shape[1])
    count = find_casters(scene.moving, view.eye, scene.casters) if scene.shadows else 0
    write_depths(hit.distance, cosines, canvas.depths)
    is_under_water = water_at(scene.world, view.eye[0], view.eye[2]) > view.eye[1]
    for row in range(view.height):
        pixels = row_in(canvas.rows, row)
        write_ways(view, row, cosines[row], pixels.ways)
        write_fog(hit.distance[row], cameras.far, pixels.fog)
        pieces = find_pieces(hit.solid[row], hit.face[row], canvas.pieces)
        if pieces > 1 or hit.solid[row, 0] != NOTHING_HIT:
            _write_surfaces(scene, view, hit, row, pieces, canvas, pixels)
            _light_surfaces(scene, view, hit, row, pieces, count, canvas, pixels)
            _write_waters(scene, view, hit, row, pieces, canvas, pixels)
        _write_sky(scene.materials.clouds, hit.solid[row], pieces, canvas, pixels)
        if is_under_water:
            write_murky(hit.distance[row], pixels, image[row])
        else:
            write_hazy(pixels, image[row])


@inlined_kernel
def _write_surfaces(
    scene: ShadedScene, view: View, hit: Hits, row: int, pieces: int, canvas: Canvas, pixels: RowOfPixels
) -> None:
    """Write the colours without light, and the normals, of what the rays of a row hit."""
    ground, statics = scene.materials.ground, scene.world.solid_kind.shape[0]
    scratch = canvas.texture
    for piece in range(pieces):
        first, last = canvas.pieces[piece], canvas.pieces[piece + 1]
        solid = hit.solid[row, first]
        if solid == TERRAIN_HIT:
            write_ground(scene.world, ground, view, hit.distance[row], first, last, scratch, pixels)
        elif solid >= statics:
            _write_moving(scene, solid - statics, hit.face[row, first], first, last, pixels)
        elif solid >= 0:
            _write_solid(
                scene, solid, hit.face[row, first], view, hit.distance[row], first, last, scratch, pixels
            )
        else:
            _write_plain((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), first, last, pixels)


@inlined_kernel
def _write_plain(color: Color, normal: Vector, first: int, last: int, pixels: RowOfPixels) -> None:
    """Write one colour and one normal to all columns from ``first`` to before ``last``."""
    _fill(pixels.color, color, first, last)
    _fill(pixels.normal, normal, first, last)


@inlined_kernel
def _fill(rows: Channels | Normals, values: Vector, first: int, last: int) -> None:
    """Write one value into each of three rows."""
    for part in range(3):
        rows[part][first:last] = values[part]


@inlined_kernel
def _write_moving(
    scene: ShadedScene, solid: int, face: int, first: int, last: int, pixels: RowOfPixels
) -> None:
    """Write what shows a face of a moving solid."""
    faces, colors = scene.moving.faces, scene.colors
    color = (colors[solid, 0], colors[solid, 1], colors[solid, 2])
    _write_plain(color, (faces[face, 0], faces[face, 1], faces[face, 2]), first, last, pixels)


@inlined_kernel
def _write_solid(
    scene: ShadedScene,
    solid: int,
    face: int,
    view: View,
    distances: NDArray[np.float32],
    first: int,
    last: int,
    scratch: TextureScratch,
    pixels: RowOfPixels,
) -> None:
    """Write what shows a face of a static solid."""
    walls, colors, axes = scene.world.faces, scene.materials.color, scene.materials.axis
    kind, normal = scene.world.solid_kind[solid], (walls[face, 0], walls[face, 1], walls[face, 2])
    base = (colors[solid, 0], colors[solid, 1], colors[solid, 2])
    axis, ways, color = (axes[solid, 0], 0.0, axes[solid, 1]), pixels.ways, pixels.color
    _fill(pixels.normal, normal, first, last)
    if has_spots(kind, normal):
        some = Ways(ways.east[first:last], ways.up[first:last], ways.north[first:last])
        shown = Channels(color.red[first:last], color.green[first:last], color.blue[first:last])
        own = pixels.normal
        facing = Normals(own.east[first:last], own.up[first:last], own.north[first:last])
        write_spotted(kind, base, facing, view, some, distances[first:last], scratch, shown)
        return
    for column in range(first, last):
        direction = way_of(ways, column)
        distance = float(distances[column])
        place = point_along(view.eye, direction, distance)
        pixel = footprint(view, direction, distance, normal)
        color.red[column], color.green[column], color.blue[column] = textured(
            kind, base, normal, place, axis, pixel
        )


@inlined_kernel
def _light_surfaces(
    scene: ShadedScene,
    view: View,
    hit: Hits,
    row: int,
    pieces: int,
    count: int,
    canvas: Canvas,
    pixels: RowOfPixels,
) -> None:
    """Apply the light of the sky and the sun to the colours of a row."""
    write_places_off(view, pixels.ways, pixels.normal, hit.distance[row], pixels.place)
    upwards, starts = scene.materials.upwards, canvas.pieces
    write_ambient(upwards, scene.world, view, hit, canvas.depths, row, starts, pieces, canvas.around, pixels)
    _write_direct(pixels.normal, pixels.direct)
    if scene.shadows:
        _write_shadows(scene, hit, row, count, canvas.texture, pixels)
    _light(pixels, 0, pixels.color.red)
    _light(pixels, 1, pixels.color.green)
    _light(pixels, 2, pixels.color.blue)


@inlined_kernel
def _write_direct(normal: Normals, direct: NDArray[np.float32]) -> None:
    """Write the sun's light on the surfaces of a row, as if nothing stood between."""
    east, up, north = np.float32(SUN_DIRECTION[0]), np.float32(SUN_DIRECTION[1]), np.float32(SUN_DIRECTION[2])
    for column in range(direct.shape[0]):
        facing = normal.east[column] * east + normal.up[column] * up + normal.north[column] * north
        direct[column] = np.float32(DIRECT) * max(NONE, facing)


@inlined_kernel
def _write_shadows(
    scene: ShadedScene, hit: Hits, row: int, count: int, scratch: TextureScratch, pixels: RowOfPixels
) -> None:
    """Take the sun's light from the surfaces of a row that are in a shadow."""
    to_sun, own, direct = scene.materials.to_sun, pixels.place, pixels.direct
    for start in range(0, direct.shape[0], AT_ONCE):
        end = min(direct.shape[0], start + AT_ONCE)
        places = Places(own.x[start:end], own.y[start:end], own.z[start:end])
        write_columns(to_sun, places, scratch.row[: end - start], scratch.column[: end - start])
        for column in range(start, end):
            if hit.solid[row, column] != NOTHING_HIT and direct[column] > NONE:
                place = place_of(own, column)
                is_shaded = is_shaded_by(scene.moving, scene.casters, count, place)
                at = column - start
                if is_shaded or not sun_shines(
                    to_sun, scene.world, scratch.row[at], scratch.column[at], place
                ):
                    direct[column] = NONE


@inlined_kernel
def _light(pixels: RowOfPixels, channel: int, own: NDArray[np.float32]) -> None:
    """Apply the light on surfaces to one channel of a row, as ``light.lit`` does."""
    sun, sky, direct, ambient = SUN_32[channel], SKY_32[channel], pixels.direct, pixels.ambient
    for column in range(own.shape[0]):
        own[column] = own[column] * (direct[column] * sun + ambient[column] * sky)


@inlined_kernel
def _write_sky(
    clouds: NDArray[np.float32], solids: NDArray[np.int32], pieces: int, canvas: Canvas, pixels: RowOfPixels
) -> None:
    """Write what is before the clear sky where the rays of a row hit nothing."""
    own, color, fog = pixels.ways, pixels.color, pixels.fog
    for piece in range(pieces):
        first, last = canvas.pieces[piece], canvas.pieces[piece + 1]
        if solids[first] == NOTHING_HIT:
            ways = Ways(own.east[first:last], own.up[first:last], own.north[first:last])
            shown = Channels(color.red[first:last], color.green[first:last], color.blue[first:last])
            write_sky(ways, clouds, canvas.texture, shown, fog[first:last])


@inlined_kernel
def _write_waters(
    scene: ShadedScene, view: View, hit: Hits, row: int, pieces: int, canvas: Canvas, pixels: RowOfPixels
) -> None:
    """Write the colours of water in its light."""
    for piece in range(pieces):
        first, last = canvas.pieces[piece], canvas.pieces[piece + 1]
        if hit.solid[row, first] == WATER_HIT:
            for column in range(first, last):
                _write_water(scene, view, float(hit.distance[row, column]), column, pixels)


@inlined_kernel
def _write_water(scene: ShadedScene, view: View, distance: float, column: int, pixels: RowOfPixels) -> None:
    """Write the colour of one pixel of water."""
    direction = way_of(pixels.ways, column)
    pixels.color.red[column], pixels.color.green[column], pixels.color.blue[column] = water_color(
        scene.world,
        scene.materials.ground,
        scene.materials.clouds,
        point_along(view.eye, direction, distance),
        direction,
        1.0 if pixels.direct[column] > NONE else 0.0,
        float(pixels.ambient[column]),
        footprint(view, direction, distance, (0.0, 1.0, 0.0)),
    )
