"""The colours that readings are shown in: one way for each kind of image a sensor makes.

Pictures keep their colours. Distances go from near, bright, to far, dark. Normals are red, green and blue by
how far they point east, up and north. Labels have a colour each.
"""

from colorsys import hsv_to_rgb
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import Kind
from wildscav_engine.sensors.optics.optical import OpticalSensor

Colors = NDArray[np.uint8]  # (H, W, 3) red, green, blue

# From near to far: the colour map "inferno" of Matplotlib (CC0), the other way round, at equal steps.
NEAR_TO_FAR = np.array(
    [
        *((252, 255, 164), (249, 201, 50), (249, 140, 10), (227, 89, 51), (186, 54, 85)),
        *((136, 34, 106), (85, 15, 109), (31, 12, 72), (0, 0, 4)),
    ],
    np.float64,
)
OF_KIND: dict[int, tuple[int, int, int]] = {
    Kind.NOTHING: (0, 0, 0),
    Kind.TERRAIN: (120, 168, 84),
    Kind.WATER: (40, 130, 215),
    Kind.WALL: (232, 214, 176),
    Kind.FLOOR: (150, 100, 60),
    Kind.STAIR: (245, 150, 40),
    Kind.ROOF: (190, 60, 50),
    Kind.TRUNK: (92, 58, 34),
    Kind.CROWN: (22, 96, 52),
    Kind.ROCK: (136, 136, 144),
    Kind.FURNITURE: (160, 70, 190),
    Kind.BUSH: (186, 220, 60),
    Kind.AGENT: (255, 30, 150),
    Kind.SUPPLY_BOX: (90, 240, 255),
}
GOLDEN = 0.6180339887498949  # of a turn from one hue to the next, so that none comes twice


def colors_of(sensor: OpticalSensor, reading: NDArray[Any]) -> Colors:
    """Return one reading of a sensor as a picture; what it is follows from its type and shape.

    Args:
        sensor: What read it.
        reading: Of the shape of its space: (H, W) distances or labels, (H, W, 3) colours or normals.
    """
    if reading.dtype == np.uint8 and reading.ndim == 3:
        return reading
    if reading.ndim == 3:
        return of_normals(reading)
    if np.issubdtype(reading.dtype, np.integer):
        return of_labels(reading)
    return of_distances(reading, sensor.lens[1])


def of_distances(distances: NDArray[np.floating], farthest: float) -> Colors:
    """Return colours for (H, W) distances in m; they get darker with the square root, to ``farthest``.

    The square root leaves more colours for what is near.
    """
    way = np.sqrt(np.clip(distances / farthest, 0.0, 1.0)) * (len(NEAR_TO_FAR) - 1)
    place = np.minimum(way.astype(np.int64), len(NEAR_TO_FAR) - 2)
    share = (way - place)[..., None]
    return np.asarray(np.round(NEAR_TO_FAR[place] * (1 - share) + NEAR_TO_FAR[place + 1] * share), np.uint8)


def of_normals(normals: NDArray[np.floating]) -> Colors:
    """Return colours for (H, W, 3) unit normals: -1 is 0 and 1 is 255; black where there is none."""
    colors = np.round((np.clip(normals, -1.0, 1.0) + 1.0) * 127.5)
    return np.asarray(np.where(normals.any(axis=-1, keepdims=True), colors, 0.0), np.uint8)


def of_labels(labels: NDArray[np.integer]) -> Colors:
    """Return colours for (H, W) labels: those of kinds as in ``OF_KIND``, any others strewn over the hues."""
    found, which = np.unique(labels, return_inverse=True)
    table = np.array([OF_KIND.get(label) or _strewn(label) for label in found.tolist()], np.uint8)
    return np.asarray(table[which.reshape(labels.shape)], np.uint8)


def _strewn(label: int) -> tuple[int, int, int]:
    """Return a bright colour for a label, unlike those of its neighbours."""
    saturation, value = (0.45, 0.95, 0.7)[label % 3], (1.0, 0.8)[label // 3 % 2]
    red, green, blue = hsv_to_rgb(label * GOLDEN % 1.0, saturation, value)
    return round(255 * red), round(255 * green), round(255 * blue)
