"""Painting a top view: colours, shading, shadows, contour lines and outlines.

A map is viewed and painted in bands, at twice the picture's resolution.
"""

import os
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.terrain import spread
from wildscav_engine.geometry.world import Kind, World
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.picture.top_view import TopView, Window, allocate_top_view, cast_top_view, cuts_at
from wildscav_engine.rendering.palette import of_solids

Value = TypeVar("Value", bound=np.generic)
Image = NDArray[np.float32]  # (rows, columns, 3) red, green, blue 0-255

PAPER = (250, 248, 243)
# The colours of the ground, from the lowest to the highest.
TINTS = np.array(
    [[168, 196, 132], [194, 208, 144], [222, 216, 160], [226, 200, 150], [208, 178, 146], [236, 230, 224]],
    np.float32,
)
TINTED_RELIEF = 45.0  # m; maps with less relief use only some of the tints
CLIFF = np.array([158, 148, 138], np.float32)
STEEP, STEEPEST = 0.65, 1.05  # m up per m, between which the ground turns to rock
SHORE = np.array([232, 218, 172], np.float32)
SHORE_WIDTH = 3.0  # m of sand along the water, approximately
SHORE_SLOPE = 0.08  # m up per m; flatter shores have no wider strip of sand
SHALLOW, DEEP = np.array([156, 206, 224], np.float32), np.array([58, 118, 172], np.float32)
DEEPEST = 5.0  # m; deeper water has the same colour
CONTOUR, WATERLINE, OUTLINE = (
    np.array(color, np.float32) for color in ((122, 84, 46), (44, 92, 140), (52, 38, 34))
)
LEAST_SLOPE = 0.006  # m up per m; a contour line on flatter ground would be a blot
# Roofs by storeys, from one to four.
STOREYS = np.array([[240, 176, 70], [222, 104, 62], [172, 52, 76], [98, 46, 112]], np.float32)
INSIDE = {  # the inside of an opened house
    Kind.FLOOR: (246, 238, 222),
    Kind.WALL: (222, 214, 200),
    Kind.STAIR: (226, 184, 126),
    Kind.FURNITURE: (190, 136, 92),
}
BRIGHTER = np.float32(1.22)  # than in the game's own light
CUT_WALL = (58, 50, 48)
SHADE = np.array([0.60, 0.65, 0.76], np.float32)  # factor of the light in shadows
DARKEST = 0.62 * SHADE
INDOOR_SHADE = np.array([0.84, 0.85, 0.89], np.float32)
RELIEF = 0.72  # strength of the shading
FINER = 2  # samples along each side of a pixel
BAND = 48  # rows of pixels painted at once
BORDER = 1  # samples around a band, for outlines
THICK = 5  # every so many contour lines, one is thick
ABOVE = 1.0  # m above the highest point of the world, where rays start


class Style(NamedTuple):
    """The parameters for painting a map, the same for every part of one picture."""

    lowest: float  # m, of the ground
    highest: float
    interval: float  # m between lines of equal height
    step: float  # m between samples
    solids: NDArray[np.float32]  # (S, 3) colours
    house_of: NDArray[np.int16]  # (S,) -1 for none
    storeys: NDArray[np.int64]  # (H,) of each house


def style_of(game_map: GameMap, step: float) -> Style:
    """Return the style for painting a map at ``step`` m between samples."""
    heights = game_map.world.heights
    lowest, highest = float(heights.min()), float(heights.max())
    return Style(
        lowest,
        highest,
        contour_interval(highest - lowest),
        step,
        BRIGHTER * of_solids(game_map.world.solid_kind, game_map.solid_house).astype(np.float32),
        game_map.solid_house,
        np.array([house.storeys for house in game_map.houses], np.int64),
    )


def contour_interval(relief: float) -> float:
    """Return a suitable distance in m between contour lines for a relief in m."""
    return next((interval for interval in (0.5, 1.0, 2.0, 5.0, 10.0) if relief <= 25 * interval), 20.0)


def paint(seen: TopView, style: Style) -> Image:
    """Return the picture of a top view, one pixel per sample; the outermost samples have no outlines."""
    picture = _ground(seen, style)
    wet = seen.kind == Kind.WATER
    picture[wet] = SHALLOW + (DEEP - SHALLOW) * np.sqrt(np.clip(seen.depth[wet] / DEEPEST, 0, 1))[:, None]
    _draw_contours(picture, seen, style)
    on_solid = (seen.solid >= 0) & (seen.kind != Kind.WATER)
    picture[on_solid] = _solids(seen, style, on_solid)
    picture *= _light(seen)
    _draw_outlines(picture, seen, style)
    picture[seen.kind == Kind.NOTHING] = PAPER
    return np.clip(picture, 0, 255)


def _ground(seen: TopView, style: Style) -> Image:
    """Tint the ground by height; rock where it is steep, sand along the water."""
    way = (seen.ground - style.lowest) / max(style.highest - style.lowest, TINTED_RELIEF)
    place = np.clip(way, 0, 0.9999) * (len(TINTS) - 1)
    tint = place.astype(np.int64)
    ground = TINTS[tint] + (TINTS[tint + 1] - TINTS[tint]) * (place - tint)[..., None]
    rocky = np.clip((seen.slope - STEEP) / (STEEPEST - STEEP), 0, 1)[..., None]
    ground += (CLIFF - ground) * rocky
    away = -seen.depth / np.maximum(seen.slope, SHORE_SLOPE)  # m from the water, about
    sandy = np.clip(2 - 2 * away / SHORE_WIDTH, 0, 1)[..., None] * (1 - rocky)
    return np.asarray(ground + (SHORE - ground) * sandy, np.float32)


def _draw_contours(picture: Image, seen: TopView, style: Style) -> None:
    """Draw lines of equal height on the ground, faintly under water, and the shore."""
    interval = style.interval
    number = np.round(seen.ground / interval)
    thick = number % THICK == 0
    rise = np.maximum(seen.slope, LEAST_SLOPE) * style.step  # m a sample
    beside = np.abs(seen.ground - number * interval) / rise  # samples from the line
    ink = np.clip(np.where(thick, 1.75, 1.15) - beside, 0, 1) * np.where(thick, 0.75, 0.5)
    # Thin lines fade out where they would be only a few samples apart.
    ink *= np.where(thick, 1, np.clip(interval / rise / 4 - 0.6, 0, 1))
    wet = seen.kind == Kind.WATER
    _ink(picture, CONTOUR, np.where(wet, 0, ink))
    _ink(picture, WATERLINE, np.where(wet, 0.45 * ink, 0))
    shore = np.clip(1.8 - np.abs(seen.depth) / rise, 0, 1)
    _ink(picture, WATERLINE, np.where(np.isfinite(seen.depth), 0.75 * shore, 0))


def _ink(picture: Image, color: NDArray[np.float32], share: NDArray[np.floating]) -> None:
    picture += (color - picture) * share[..., None].astype(np.float32)


def _solids(seen: TopView, style: Style, chosen: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Return (N, 3) colours of the samples that show solids."""
    solid, kind = seen.solid[chosen], seen.kind[chosen]
    colors = style.solids[solid]
    house = style.house_of[solid]
    inside = house >= 0
    if inside.any():
        roofs = STOREYS[np.clip(style.storeys[house[inside]], 1, 4) - 1]
        stairs = (kind[inside] == Kind.STAIR)[:, None]
        colors[inside] = np.where(stairs, 0.5 * roofs + 110, roofs)
    opened = seen.opened[chosen] & inside
    for one, color in INSIDE.items():
        colors[opened & (kind == one)] = color
    colors[seen.cut[chosen] & inside & (kind != Kind.STAIR) & (kind != Kind.FURNITURE)] = CUT_WALL
    return colors


def _light(seen: TopView) -> Image:
    """Return the brightness of each sample, by its slope and the shadows."""
    light = ((1 - RELIEF) + RELIEF * np.clip(seen.light, 0, 1.5))[..., None]
    shadow = ~seen.sunny[..., None]
    outside = np.where(shadow, np.maximum(light * SHADE, DARKEST), np.clip(light, 0.45, 1.12))
    inside = (0.5 + 0.5 * light) * np.where(shadow, INDOOR_SHADE, np.float32(1))
    is_inside = (seen.opened & (seen.solid >= 0))[..., None]
    return np.asarray(np.where(is_inside, inside, outside), np.float32)


def _draw_outlines(picture: Image, seen: TopView, style: Style) -> None:
    """Draw the edges of houses, and of the solids in opened ones."""
    house = np.full(seen.solid.shape, -1, np.int16)
    on_solid = seen.solid >= 0
    house[on_solid] = style.house_of[seen.solid[on_solid]]
    ink = np.zeros(house.shape, np.float32)
    for axis in (0, 1):
        first, second = (_shifted(house, axis, by) for by in (0, 1))
        low, high = (_shifted(seen.height, axis, by) for by in (0, 1))
        opened = _shifted(seen.opened, axis, 0) & _shifted(seen.opened, axis, 1)
        gap = np.abs(high - low)
        edge = np.where(first != second, 0.85, 0)
        step = np.where(opened, 0.5 * (gap > 0.12), 0.45 * (gap > 0.6))
        edge = np.maximum(edge, np.where((first == second) & (first >= 0), step, 0))
        for by in (0, 1):
            part = _shifted(ink, axis, by)
            np.maximum(part, edge, out=part)
    _ink(picture, OUTLINE, ink)


def _shifted(array: NDArray[Value], axis: int, by: int) -> NDArray[Value]:
    """Return an array without its last (0) or its first (1) row or column."""
    chosen = slice(by, array.shape[axis] - 1 + by)
    return array[chosen] if axis == 0 else array[:, chosen]


def raster(game_map: GameMap, window: Window, storey: int | None) -> NDArray[np.uint8]:
    """Return the picture of a window, (rows, columns, 3), houses cut open as in ``draw_map``."""
    world, fine = game_map.world, window.step / FINER
    water, cuts, style = water_nearby(world), cuts_at(game_map, storey), style_of(game_map, fine)
    sky = float(world.block_top.max()) + ABOVE

    def band(first: int) -> NDArray[np.uint8]:
        rows = min(BAND, window.rows - first)
        part = Window(
            window.west - BORDER * fine,
            window.north - first * window.step + BORDER * fine,
            fine,
            rows * FINER + 2 * BORDER,
            window.columns * FINER + 2 * BORDER,
        )
        seen = allocate_top_view(part.rows, part.columns)
        cast_top_view(world, water, sky, cuts, part, seen)
        picture = paint(seen, style)[BORDER:-BORDER, BORDER:-BORDER]
        pixels = picture.reshape(rows, FINER, window.columns, FINER, 3).mean(axis=(1, 3))
        return np.asarray(pixels + 0.5, np.uint8)

    # Kernels and NumPy release the interpreter lock, so bands are rendered in parallel.
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return np.concatenate(list(pool.map(band, range(0, window.rows, BAND))))


def water_nearby(world: World) -> NDArray[np.float64]:
    """Return (R, C) the height in m of the water in or near each cell, -inf without any.

    The picture's smoothed ground crosses the water's surface slightly beside the real shore, perhaps in the
    next cell, and the picture also shows beaches.
    """
    return spread(world.water, 2)
