"""The colours in which sensor readings are displayed.

Colour images stay as they are. Distances run from bright (near) to dark (far). The red, green and blue of
normals are their components to the east, up and north. Each label has a colour of its own.
"""

from colorsys import hsv_to_rgb
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import Kind
from wildscav_engine.sensors.optics.image_sensor import ImageSensor

Colors = NDArray[np.uint8]  # (H, W, 3) red, green, blue

# From near to far: the colour map "inferno" of Matplotlib (CC0), reversed, at equal steps.
NEAR_TO_FAR = np.array(
    [
        *((252, 255, 164), (249, 201, 50), (249, 140, 10), (227, 89, 51), (186, 54, 85)),
        *((136, 34, 106), (85, 15, 109), (31, 12, 72), (0, 0, 4)),
    ],
    np.float64,
)
KIND_COLORS: dict[int, tuple[int, int, int]] = {
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
HUE_STEP = 0.6180339887498949  # of a turn, the golden ratio: no hue occurs twice


def reading_colors(sensor: ImageSensor, reading: NDArray[Any]) -> Colors:
    """Return one reading of a sensor as an image; its dtype and shape tell what kind of reading it is.

    Distances and labels are (H, W), colours and normals (H, W, 3).
    """
    if reading.dtype == np.uint8 and reading.ndim == 3:
        return reading
    if reading.ndim == 3:
        return normal_colors(reading)
    if np.issubdtype(reading.dtype, np.integer):
        return label_colors(reading)
    return distance_colors(reading, sensor.lens[1])


def distance_colors(distances: NDArray[np.floating], farthest: float) -> Colors:
    """Return colours for (H, W) distances in m, which darken with the square root up to ``farthest``.

    The square root leaves more colours for near distances.
    """
    scaled = np.sqrt(np.clip(distances / farthest, 0.0, 1.0)) * (len(NEAR_TO_FAR) - 1)
    place = np.minimum(scaled.astype(np.int64), len(NEAR_TO_FAR) - 2)
    share = (scaled - place)[..., None]
    return np.asarray(np.round(NEAR_TO_FAR[place] * (1 - share) + NEAR_TO_FAR[place + 1] * share), np.uint8)


def normal_colors(normals: NDArray[np.floating]) -> Colors:
    """Return colours for (H, W, 3) unit normals: -1 is 0 and 1 is 255; black where there is no surface."""
    colors = np.round((np.clip(normals, -1.0, 1.0) + 1.0) * 127.5)
    return np.asarray(np.where(normals.any(axis=-1, keepdims=True), colors, 0.0), np.uint8)


def label_colors(labels: NDArray[np.integer]) -> Colors:
    """Return colours for (H, W) labels: kinds as in ``KIND_COLORS``, other labels spread over the hues."""
    distinct, index = np.unique(labels, return_inverse=True)
    table = np.array(
        [KIND_COLORS.get(label) or _distinct_color(label) for label in distinct.tolist()], np.uint8
    )
    return np.asarray(table[index.reshape(labels.shape)], np.uint8)


def _distinct_color(label: int) -> tuple[int, int, int]:
    """Return a bright colour for a label, unlike those of the next labels."""
    saturation, value = (0.45, 0.95, 0.7)[label % 3], (1.0, 0.8)[label // 3 % 2]
    red, green, blue = hsv_to_rgb(label * HUE_STEP % 1.0, saturation, value)
    return round(255 * red), round(255 * green), round(255 * blue)
