"""Shading one picture: the colour of what each ray hit, in the light of the sun and the sky."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel
from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT
from wildscav_engine.geometry.terrain import water_at
from wildscav_engine.geometry.world import World
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.hits import WATER_HIT, Hits
from wildscav_engine.rendering.shading.appearance import Materials
from wildscav_engine.rendering.shading.coarse_shading import (
    Chosen,
    choose_half,
    choose_unlike,
    repeat_row,
    spread_colors,
)
from wildscav_engine.rendering.shading.color_arithmetic import Color, Vector
from wildscav_engine.rendering.shading.ground import write_ground
from wildscav_engine.rendering.shading.light.ambient_light import (
    write_ambient,
    write_places_off,
    write_skylight,
)
from wildscav_engine.rendering.shading.light.ambient_occlusion import Around, write_depths
from wildscav_engine.rendering.shading.light.moving_shadows import Casters, find_casters
from wildscav_engine.rendering.shading.light.sunlight import DIRECT, SKY_COLOR, SUN_COLOR, write_shadows
from wildscav_engine.rendering.shading.pixel_rows import (
    Channels,
    RowOfPixels,
    TextureScratch,
    TracedRow,
    Vectors,
    View,
    channels_in,
    footprint,
    point_along,
    row_in,
    vector_at,
    vectors_in,
    view_of,
    write_directions,
)
from wildscav_engine.rendering.shading.sky import SUN_DIRECTION, add_haze, write_fog, write_sky
from wildscav_engine.rendering.shading.surfaces import has_spots, textured, write_spotted
from wildscav_engine.rendering.shading.water import add_murk, lighten, write_bed, write_reflection
from wildscav_engine.rendering.tracing.frustum import nonnegative
from wildscav_engine.rendering.tracing.solids import Solids

NONE = np.float32(0.0)
SUN_32 = tuple(np.float32(part) for part in SUN_COLOR)
SKY_32 = tuple(np.float32(part) for part in SKY_COLOR)
COMPARED = 16  # pixels that are compared at once


class ShadedScene(NamedTuple):
    """A map and its moving objects with everything that shading needs."""

    world: World
    materials: Materials
    moving: Solids  # S solids
    colors: NDArray[np.float64]  # (S, 3) of the moving solids
    casters: Casters  # those that cast shadows in the current image
    shadows: bool  # whether solids cast shadows
    is_fast: bool  # whether colours are simpler, and neighbouring pixels share them


class Rows(NamedTuple):
    """Scratch buffers for an image and its rows."""

    depths: NDArray[np.float32]  # (H, W) m
    pixels: NDArray[np.float32]  # as of ``allocate_rows``
    pieces: NDArray[np.int32]  # (W + 1,)


class Canvas(NamedTuple):
    """Scratch buffers for shading an image."""

    rows: Rows
    chosen: Chosen  # in full pictures only with all columns
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
    view = view_of(cameras, number, image.shape[0], image.shape[1], 2 if scene.is_fast else 1)
    if scene.shadows:
        find_casters(scene.moving, view.eye, scene.casters)
    if not scene.is_fast:
        write_depths(hit.distance, cosines, canvas.rows.depths)
        for column in range(view.width):
            canvas.chosen.column[column] = column
    is_under_water = water_at(scene.world, view.eye[0], view.eye[2]) > view.eye[1]
    for number_of_row in range(view.height):
        row = _row_of(scene, view, hit, number_of_row, cosines, canvas)
        if scene.is_fast and number_of_row & 1:
            repeat_row(image, number_of_row)
        if row.piece_count == 0:
            continue
        pixels, distances = row.pixels, row.line.distance
        write_fog(distances, cameras.far, pixels.fog)
        if row.piece_count > 1 or row.line.solid[0] != NOTHING_HIT:
            _write_surfaces(scene, row, canvas.texture)
            _light_surfaces(scene, row, canvas)
            _write_reflections(scene.materials.surfaces.clouds, row, canvas.texture)
        _write_sky(scene.materials.surfaces.clouds, row, canvas.texture)
        if is_under_water:
            add_murk(distances, pixels)
        else:
            add_haze(pixels)
        if scene.is_fast:
            spread_colors(pixels, canvas.chosen, image[number_of_row])
        else:
            _write_colors(pixels, image[number_of_row])


@inlined_kernel
def _row_of(
    scene: ShadedScene, view: View, hit: Hits, number: int, cosines: NDArray[np.float32], canvas: Canvas
) -> TracedRow:
    """Return a row of an image, with its pieces and its rays: all, or the chosen ones."""
    chosen, own, line = canvas.chosen, cosines[number], _line_of(hit, number)
    if scene.is_fast and number & 1:
        pieces, count = choose_unlike(line, _line_of(hit, number - 1), own, canvas.rows.pieces, chosen)
    else:
        pieces, count = find_pieces(line.solid, line.face, canvas.rows.pieces), view.width
        if scene.is_fast:
            count = choose_half(line, own, canvas.rows.pieces, pieces, chosen)
    if scene.is_fast:
        line = Hits(chosen.distance[:count], chosen.solid[:count], chosen.face[:count])
        own = chosen.cosine[:count]
    pixels = row_in(canvas.rows.pixels, number, count)
    write_directions(view, number, chosen.column[:count], own, pixels.ways)
    return TracedRow(view, hit, number, line, canvas.rows.pieces, pieces, pixels)


@inlined_kernel
def _line_of(hit: Hits, number: int) -> Hits:
    """Return one row of an image."""
    return Hits(hit.distance[number], hit.solid[number], hit.face[number])


@inlined_kernel
def _write_surfaces(scene: ShadedScene, row: TracedRow, scratch: TextureScratch) -> None:
    """Write the colours without light, and the normals, of what the rays of a row hit."""
    ground, statics = scene.materials.surfaces.ground, scene.world.solid_kind.shape[0]
    for piece in range(row.piece_count):
        first, last = row.pieces[piece], row.pieces[piece + 1]
        solid, face = row.line.solid[first], row.line.face[first]
        if solid == TERRAIN_HIT:
            write_ground(scene.world, ground, row, first, last, scene.is_fast, scratch)
        elif solid == WATER_HIT:
            write_bed(scene.world, ground, row, first, last, scene.is_fast, scratch)
        elif solid >= statics:
            _write_moving(scene, solid - statics, face, first, last, row.pixels)
        elif solid >= 0:
            _write_solid(scene, solid, face, row, first, last, scratch)
        else:
            _write_plain((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), first, last, row.pixels)


@inlined_kernel
def _write_plain(color: Color, normal: Vector, first: int, last: int, pixels: RowOfPixels) -> None:
    """Write one colour and one normal to all columns from ``first`` to before ``last``."""
    _fill(pixels.color, color, first, last)
    _fill(pixels.normal, normal, first, last)


@inlined_kernel
def _fill(rows: Channels | Vectors, values: Vector, first: int, last: int) -> None:
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
    scene: ShadedScene, solid: int, face: int, row: TracedRow, first: int, last: int, scratch: TextureScratch
) -> None:
    """Write what shows a face of a static solid."""
    view, distances, pixels = row.camera, row.line.distance, row.pixels
    walls, colors, axes = scene.world.faces, scene.materials.surfaces.color, scene.materials.surfaces.axis
    kind, normal = scene.world.solid_kind[solid], (walls[face, 0], walls[face, 1], walls[face, 2])
    base = (colors[solid, 0], colors[solid, 1], colors[solid, 2])
    axis, ways, color = (axes[solid, 0], 0.0, axes[solid, 1]), pixels.ways, pixels.color
    _fill(pixels.normal, normal, first, last)
    if has_spots(kind, normal):
        some, facing = vectors_in(ways, first, last), vectors_in(pixels.normal, first, last)
        shown = channels_in(color, first, last)
        write_spotted(kind, base, facing, view, some, distances[first:last], scratch, shown)
        return
    for column in range(first, last):
        direction, distance = vector_at(ways, column), float(distances[column])
        place = point_along(view.eye, direction, distance)
        pixel = footprint(view, direction, distance, normal)
        color.red[column], color.green[column], color.blue[column] = textured(
            kind, base, normal, place, axis, pixel
        )


@inlined_kernel
def _light_surfaces(scene: ShadedScene, row: TracedRow, canvas: Canvas) -> None:
    """Apply the light of the sky and the sun to the colours of a row."""
    pixels, solids = row.pixels, row.line.solid
    write_places_off(row.camera, pixels.ways, pixels.normal, row.line.distance, pixels.place)
    if scene.is_fast:
        write_skylight(pixels.normal, False, pixels.ambient)
    else:
        write_ambient(scene.materials.upwards, scene.world, row, canvas.rows.depths, canvas.around)
    _write_direct(pixels.normal, pixels.direct)
    if scene.shadows:
        to_sun, world, moving = scene.materials.to_sun, scene.world, scene.moving
        write_shadows(to_sun, world, moving, scene.casters, solids, canvas.texture, pixels)
    for piece in range(row.piece_count):
        first, last = row.pieces[piece], row.pieces[piece + 1]
        if solids[first] == WATER_HIT:
            lighten(pixels.direct[first:last])
    _light(pixels, 0, pixels.color.red)
    _light(pixels, 1, pixels.color.green)
    _light(pixels, 2, pixels.color.blue)


@inlined_kernel
def _write_direct(normal: Vectors, direct: NDArray[np.float32]) -> None:
    """Write the sun's light on the surfaces of a row, as if nothing stood between."""
    east, up, north = np.float32(SUN_DIRECTION[0]), np.float32(SUN_DIRECTION[1]), np.float32(SUN_DIRECTION[2])
    for column in range(direct.shape[0]):
        facing = normal.east[column] * east + normal.up[column] * up + normal.north[column] * north
        direct[column] = np.float32(DIRECT) * max(NONE, facing)


@inlined_kernel
def _light(pixels: RowOfPixels, channel: int, own: NDArray[np.float32]) -> None:
    """Apply the light on surfaces to one channel of a row."""
    sun, sky, direct, ambient = SUN_32[channel], SKY_32[channel], pixels.direct, pixels.ambient
    for column in range(own.shape[0]):
        own[column] = own[column] * (direct[column] * sun + ambient[column] * sky)


@inlined_kernel
def _write_sky(clouds: NDArray[np.float32], row: TracedRow, scratch: TextureScratch) -> None:
    """Write what is before the clear sky where the rays of a row hit nothing."""
    own, color, fog = row.pixels.ways, row.pixels.color, row.pixels.fog
    for piece in range(row.piece_count):
        first, last = row.pieces[piece], row.pieces[piece + 1]
        if row.line.solid[first] == NOTHING_HIT:
            ways, shown = vectors_in(own, first, last), channels_in(color, first, last)
            write_sky(ways, clouds, scratch, shown, fog[first:last])


@inlined_kernel
def _write_reflections(clouds: NDArray[np.float32], row: TracedRow, scratch: TextureScratch) -> None:
    """Write what water reflects."""
    for piece in range(row.piece_count):
        first, last = row.pieces[piece], row.pieces[piece + 1]
        if row.line.solid[first] == WATER_HIT:
            write_reflection(clouds, row, first, last, scratch)


@inlined_kernel
def _write_colors(pixels: RowOfPixels, colors: NDArray[np.uint8]) -> None:
    """Write (W, 3) the colours of a row."""
    red, green, blue = pixels.color
    for column in range(colors.shape[0]):
        colors[column, 0] = np.int32(red[column])
        colors[column, 1] = np.int32(green[column])
        colors[column, 2] = np.int32(blue[column])


@disjoint_kernel
def find_pieces(solids: NDArray[np.int32], faces: NDArray[np.int32], pieces: NDArray[np.int32]) -> int:
    """Find the pieces of a row, given what its W rays hit, as in ``Hits``; return how many there are.

    ``pieces``, (W + 1,), gets the first column of each, then the column after the last.
    """
    width, count = solids.shape[0], 1
    pieces[0] = 0
    for start in range(1, width, COMPARED):
        end = min(width, start + COMPARED)
        if _is_one_surface(solids[start - 1 : end], faces[start - 1 : end]):
            continue
        for column in range(start, end):
            # Always written, counted only if it begins a piece: this avoids branches.
            pieces[nonnegative(count)] = column
            is_other_face = (faces[column] != faces[column - 1]) & (solids[column] != TERRAIN_HIT)
            count += (solids[column] != solids[column - 1]) | is_other_face
    pieces[nonnegative(count)] = width
    return count


@disjoint_kernel
def _is_one_surface(solids: NDArray[np.int32], faces: NDArray[np.int32]) -> bool:
    """Return whether successive pixels all show one surface, in a loop that vectorizes."""
    is_other = np.int32(0)
    for column in range(1, solids.shape[0]):
        is_other_face = np.int32(faces[column] != faces[0]) & np.int32(solids[0] != TERRAIN_HIT)
        is_other |= np.int32(solids[column] != solids[0]) | is_other_face
    return bool(is_other == 0)
