"""The colours of the world, as red, green, blue 0-255, and the fixed sun that lights them.

Replays, pictures and exported meshes share them, so that a map looks the same everywhere.
"""

import colorsys

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import Kind

Colors = NDArray[np.uint8]
Array = NDArray[np.floating]

SUN = np.array([-0.45, 0.75, -0.48])  # direction towards it, in the game's frame
SUNLIGHT = np.array([0.56, 0.53, 0.46])
SKYLIGHT = np.array([0.56, 0.59, 0.64])  # from straight above; a third of it from below

GRASS, DRY_GRASS = np.array([98, 146, 62]), np.array([154, 163, 84])
STONE, SAND, LAKE_BED = np.array([137, 128, 116]), np.array([222, 202, 150]), np.array([40, 92, 112])
WATER = (40, 130, 215, 140)
WALLS = ([228, 214, 188], [206, 160, 122], [217, 190, 132], [188, 198, 202], [230, 226, 216], [190, 140, 116])
ROOFS = ([166, 70, 52], [112, 74, 62], [88, 98, 116], [146, 92, 58], [120, 58, 54])
OF_KIND = {
    Kind.WALL: [186, 182, 174],  # a wall that belongs to no house: a block
    Kind.FLOOR: [150, 116, 82],
    Kind.STAIR: [196, 150, 96],
    Kind.TRUNK: [98, 70, 46],
    Kind.ROCK: [136, 134, 130],
    Kind.FURNITURE: [170, 110, 70],
}
CROWNS = ([58, 118, 50], [84, 138, 54], [44, 98, 58], [112, 144, 58])
BUSHES = ([92, 128, 52], [74, 120, 66], [118, 138, 62])
SUPPLY_BOX = (90, 200, 255)


def shaded(base: Array, normals: Array) -> Colors:
    """Light (N, 3) colours by (N, 3) unit normals in the game's frame."""
    sun = SUN / np.linalg.norm(SUN)
    direct = np.maximum(0.0, normals @ sun)[:, None] * SUNLIGHT
    sky = (0.67 + 0.33 * normals[:, 1])[:, None] * SKYLIGHT
    return np.asarray(np.clip(base * (direct + sky), 0, 255), np.uint8)


def of_terrain(height_over_water: Array, up: Array, noise: Array) -> NDArray[np.float64]:
    """Return (N, 3) colours of ground: lake beds, sand on shores, grass, dry grass, stone where it is steep.

    Args:
        height_over_water: (N,) m above the nearest lake, negative below it, inf without one.
        up: (N,) the upward part of the unit normal.
        noise: (N,) 0-1, how dry the grass is.
    """
    ground = mix(GRASS[None], DRY_GRASS[None], noise)
    ground = mix(ground, STONE[None], np.clip((0.90 - up) / 0.12, 0, 1))
    ground = mix(SAND[None], ground, np.clip((height_over_water - 0.25) / 0.5, 0, 1))
    return mix(ground, LAKE_BED[None], np.clip(-height_over_water / 1.5, 0, 1))


def of_solids(kinds: NDArray[np.int8], houses: NDArray[np.int16]) -> NDArray[np.float64]:
    """Return (S, 3) colours of solids by (S,) kinds and houses (-1: none), with slight variations."""
    count = len(kinds)
    colors = np.full((count, 3), 160.0)
    for kind, color in OF_KIND.items():
        colors[kinds == kind] = color
    in_house, every = houses >= 0, np.arange(count)
    for kind, palette, chosen, key in (
        (Kind.WALL, WALLS, in_house, houses),
        (Kind.ROOF, ROOFS, in_house, houses),
        (Kind.CROWN, CROWNS, True, every),
        (Kind.BUSH, BUSHES, True, every),
    ):
        painted = (kinds == kind) & chosen
        colors[painted] = np.array(palette)[_scatter(key[painted]) % len(palette)]
    varied = np.isin(kinds, (Kind.CROWN, Kind.BUSH, Kind.ROCK, Kind.TRUNK))
    brightness = np.where(varied, 0.88 + 0.24 * (_scatter(every) % 17) / 16, 1.0)
    return colors * brightness[:, None]


def of_seat(seat: int) -> tuple[int, int, int]:
    """Return a saturated colour for a seat; those of the first dozen seats differ clearly."""
    hue = (0.02 + 0.381966 * seat) % 1.0  # the golden angle
    red, green, blue = colorsys.hsv_to_rgb(hue, 0.80 - 0.25 * (seat // 7 % 2), 1.0)
    return round(255 * red), round(255 * green), round(255 * blue)


def mix(first: Array, second: Array, share: Array) -> NDArray[np.float64]:
    """Return (N, 3) linear blends of two colours, by the (N,) shares of the second."""
    return np.asarray(first + (second - first) * share[:, None], np.float64)


def _scatter(numbers: NDArray[np.integer]) -> NDArray[np.int64]:
    """Hash integers so that neighbours get different remainders."""
    return np.asarray((numbers.astype(np.int64) + 1) * 2654435761 % 4294967296 >> 7, np.int64)
