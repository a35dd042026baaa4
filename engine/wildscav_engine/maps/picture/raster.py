"""Rendering the map itself: viewed from above and painted in bands, at twice the picture's resolution."""

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import World
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.picture.paint import paint, style_of
from wildscav_engine.maps.picture.top_view import Window, allocate_top_view, cast_top_view, cuts_at

FINER = 2  # samples along each side of a pixel
BAND = 48  # rows of pixels painted at once
BORDER = 1  # samples around a band, for outlines
ABOVE = 1.0  # m above the highest point of the world, where rays start


def raster(game_map: GameMap, window: Window, storey: int | None) -> NDArray[np.uint8]:
    """Return the picture of a window, (rows, columns, 3).

    Args:
        window: The part to show, one sample per pixel.
        storey: The storey at which to cut houses open, 1 for the ground floor; None to cut none.
    """
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
    nearby = world.water.copy()
    for axis in (0, 1, 0, 1):
        padded = np.pad(
            nearby, [(1, 1) if side == axis else (0, 0) for side in (0, 1)], constant_values=-np.inf
        )
        parts = [padded.take(range(by, by + nearby.shape[axis]), axis=axis) for by in range(3)]
        nearby = np.maximum(np.maximum(parts[0], parts[1]), parts[2])
    return np.ascontiguousarray(nearby)
