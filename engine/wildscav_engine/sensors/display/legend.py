"""Sensor readings as images with a legend beneath them. Pillow is imported only when one is drawn."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import Kind
from wildscav_engine.sensors.display.colors import (
    KIND_COLORS,
    Colors,
    distance_colors,
    normal_colors,
    reading_colors,
)
from wildscav_engine.sensors.optics.image_sensor import ImageSensor
from wildscav_engine.sensors.optics.lidar import Lidar

if TYPE_CHECKING:
    from PIL.Image import Image
    from PIL.ImageDraw import ImageDraw

MIN_WIDTH = 400  # pixels that a legend needs
MAX_ROWS = 4000  # of an image that is enlarged for its legend
LINE, TEXT, SWATCH, GAP = 24, 13, 12, 10  # pixels: line height, text size, side of a colour patch, and gaps
PAPER, INK = (250, 248, 243), (44, 40, 38)
STEPS = (0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000)  # m, the labels that a scale may have
LABEL_WIDTH = 46  # pixels between two labels
AXES = {
    "east": (1, 0, 0),
    "west": (-1, 0, 0),
    "up": (0, 1, 0),
    "down": (0, -1, 0),
    "north": (0, 0, 1),
    "south": (0, 0, -1),
}


def draw_reading(sensor: ImageSensor, reading: NDArray[Any], *, legend: bool = True) -> "Image":
    """Return one reading as an image in red, green and blue.

    Args:
        sensor: The sensor.
        reading: An array of the shape of its space.
        legend: Whether to explain the colours beneath the image; colour images have no legend. Images that
            are too small for it are enlarged, each pixel to a block. Without a legend, each pixel of the
            reading is one pixel of the image.
    """
    from PIL import Image

    colors = reading_colors(sensor, reading)
    if not legend or (reading.dtype == np.uint8 and reading.ndim == 3):
        return Image.fromarray(colors)
    image = Image.fromarray(_enlarged(sensor, colors))
    if reading.ndim == 3:
        return _with_patches(image, _patches_of_normals())
    if np.issubdtype(reading.dtype, np.integer):
        return _with_patches(image, _patches_of_labels(reading))
    return _with_scale(image, sensor.lens[1])


def _enlarged(sensor: ImageSensor, colors: Colors) -> Colors:
    """Enlarge each pixel to a block, for the legend or because rings are farther apart than columns."""
    times = max(1, min(-(-MIN_WIDTH // colors.shape[1]), MAX_ROWS // colors.shape[0]))
    tall = times
    if isinstance(sensor, Lidar) and sensor.channels > 1:
        apart = (sensor.highest - sensor.lowest) / (sensor.channels - 1)
        tall = max(1, round(times * apart * sensor.azimuths / 360.0))
    return colors.repeat(tall, axis=0).repeat(times, axis=1)


def _patches_of_normals() -> list[tuple[str, tuple[int, int, int]]]:
    colors = normal_colors(np.array([list(AXES.values())], np.float64))[0].tolist()
    return [(name, (red, green, blue)) for name, (red, green, blue) in zip(AXES, colors, strict=True)]


def _patches_of_labels(labels: NDArray[np.integer]) -> list[tuple[str, tuple[int, int, int]]]:
    """Return the names and colours of the visible kinds; instances have no names."""
    seen = [Kind(label) for label in np.unique(labels).tolist() if label in KIND_COLORS]
    patches = [(kind.name.lower().replace("_", " "), KIND_COLORS[kind]) for kind in seen]
    return (
        patches
        if labels.max(initial=0) in KIND_COLORS
        else [*patches, ("others: one colour per object", PAPER)]
    )


def _with_patches(image: "Image", patches: list[tuple[str, tuple[int, int, int]]]) -> "Image":
    """Draw named patches of colour beneath an image, in as many lines as they need."""
    from PIL import ImageFont

    font = ImageFont.load_default(TEXT)
    places, x, line = [], GAP, 0
    for name, _ in patches:
        width = SWATCH + 5 + round(font.getlength(name)) + GAP
        if x > GAP and x + width > image.width:
            x, line = GAP, line + 1
        places.append((x, line))
        x += width
    sheet, draw = _sheet(image, line + 1)
    for (name, color), (left, line) in zip(patches, places, strict=True):
        middle = image.height + line * LINE + LINE // 2
        draw.rectangle(
            (left, middle - SWATCH // 2, left + SWATCH, middle + SWATCH // 2),
            color,
            None if color == PAPER else INK,
        )
        draw.text((left + SWATCH + 5, middle), name, INK, font, anchor="lm")
    return sheet


def _with_scale(image: "Image", farthest: float) -> "Image":
    """Draw the scale of the colours of distances beneath an image, from 0 to the farthest."""
    from PIL import Image, ImageFont

    font = ImageFont.load_default(TEXT)
    sheet, draw = _sheet(image, 2)
    left, width, top = GAP, image.width - 2 * GAP, image.height + 6
    distances = ((np.arange(width) + 0.5) / width) ** 2 * farthest
    bar = distance_colors(np.tile(distances, (SWATCH, 1)), farthest)
    sheet.paste(Image.fromarray(bar), (left, top))
    end = -np.inf
    for distance in (0.0, *(step for step in STEPS if step < farthest), farthest):
        at = left + width * np.sqrt(distance / farthest)
        last = distance == farthest
        if not last and (at < end or at > left + width - 2 * LABEL_WIDTH):
            continue
        draw.line((at, top + SWATCH, at, top + SWATCH + 4), INK)
        text = f"{distance:g} m" if last else f"{distance:g}"
        anchor = "rt" if last else "lt" if distance == 0.0 else "mt"
        draw.text((at, top + SWATCH + 8), text, INK, font, anchor=anchor)
        end = at + LABEL_WIDTH
    return sheet


def _sheet(image: "Image", lines: int) -> "tuple[Image, ImageDraw]":
    """Return a sheet with an image and space for lines beneath it, and its drawing interface."""
    from PIL import Image, ImageDraw

    sheet = Image.new("RGB", (image.width, image.height + lines * LINE), PAPER)
    sheet.paste(image, (0, 0))
    return sheet, ImageDraw.Draw(sheet)
