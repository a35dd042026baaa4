"""Importing a greyscale picture as ground: brighter is higher."""

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import CELL
from wildscav_engine.maps.base import HIGHEST, LARGEST, LOWEST, SMALLEST, Base, BaseError, Imported, finish

if TYPE_CHECKING:
    from PIL.Image import Image

MAX_PIXELS = 8192  # of a side
WHITE = {"L": 255.0, "I;16": 65535.0, "I;16B": 65535.0, "I;16L": 65535.0}  # by Pillow's name of the pixels
STRIP = 128  # columns of pixels processed at once
COARSE = 0.1  # m between two shades of grey above which slopes look like steps


def import_height_map(
    path: Path,
    size: int,
    lowest: float,
    highest: float,
    *,
    water_level: float | None = None,
    name: str | None = None,
) -> Imported:
    """Make a base from a square greyscale picture of 8 or 16 bits per pixel, with north at the top.

    Args:
        path: The picture.
        size: m, of each side of the map.
        lowest: m, height of black.
        highest: m, height of white.
        water_level: m; None for no water.
        name: The name of the base; None for the file's name.

    Returns:
        The base, and notes about it.

    Raises:
        BaseError: The file is not such a picture, or no map can be made on it.
    """
    if not (SMALLEST <= size <= LARGEST and size % 2 == 0):
        raise BaseError(f"size is {size}, must be an even number of metres from {SMALLEST} to {LARGEST}")
    if not LOWEST <= lowest <= highest <= HIGHEST:
        raise BaseError(
            f"the heights run from {lowest:g} to {highest:g} m, must ascend and lie from {LOWEST:g} to "
            f"{HIGHEST:g} m"
        )
    try:
        points = round(size / CELL) + 1
        shares, white = _read(path, points)
    except BaseError as error:
        raise BaseError(f"{path}: {error}") from None
    heights = lowest + (highest - lowest) * shares[::-1]
    step = (highest - lowest) / white
    notes = []
    if step > COARSE:
        notes.append(
            f"two shades of grey are {step:.2f} m apart: slopes get steps; 16 bits a pixel are smoother"
        )
    level = -np.inf if water_level is None else water_level
    return finish(Base(np.ascontiguousarray(heights), level, (), size, name or path.stem), notes)


def _read(path: Path, points: int) -> tuple[NDArray[np.float64], float]:
    """Return the brightness of a picture at ``points`` points per side, southwards, and white's value."""
    from PIL import Image, UnidentifiedImageError

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            picture = Image.open(path, formats=["PNG"])
        with picture:
            width, height = picture.size
            if width != height or not 2 <= width <= MAX_PIXELS:
                raise BaseError(
                    f"it is {width} × {height} pixels; a map is square, of 2 to {MAX_PIXELS} pixels a side"
                )
            if picture.mode not in WHITE:
                raise BaseError(f"its pixels are {picture.mode}, must be grey of 8 or 16 bits without alpha")
            white = WHITE[picture.mode]
            return _brightness(picture, white, points), white
    except UnidentifiedImageError:
        raise BaseError("it is no PNG picture") from None
    except OSError as error:
        raise BaseError(f"cannot be read: {error.strerror or error}") from None
    except (SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise BaseError(f"it is damaged: {error}") from None


def _brightness(picture: "Image", white: float, points: int) -> NDArray[np.float64]:
    """Return the brightness of a picture, (points, points), from 0 to 1, read a few columns at a time."""
    side = picture.size[0]
    columns = np.empty((points, side))
    for left in range(0, side, STRIP):
        strip = np.asarray(picture.crop((left, 0, min(left + STRIP, side), side))).astype(np.float64)
        columns[:, left : left + STRIP] = _resample(strip / white, points)
    shares = np.empty((points, points))
    for top in range(0, points, STRIP):
        shares[top : top + STRIP] = _resample(columns[top : top + STRIP].T, points).T
    return shares


def _resample(rows: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Resample rows to ``count`` rows; the first and the last stay in place.

    Upsampling interpolates linearly. When downsampling, each new row is the average of the interval around
    it.
    """
    last = len(rows) - 1
    apart = last / (count - 1)
    places = np.arange(count, dtype=np.float64) * apart
    if apart <= 1.0:
        before, share = _between(places, last)
        return rows[before] + (rows[before + 1] - rows[before]) * share
    low, high = np.maximum(0.0, places - apart / 2), np.minimum(last, places + apart / 2)
    areas = np.zeros_like(rows)  # integrals of the linear interpolation from the first row
    areas[1:] = np.cumsum((rows[:-1] + rows[1:]) / 2, axis=0)
    averages: NDArray[np.float64] = _area(rows, areas, high) - _area(rows, areas, low)
    averages /= (high - low)[:, None]
    return averages


def _area(
    rows: NDArray[np.float64], areas: NDArray[np.float64], places: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the integrals of the linear interpolation from the first row to each place."""
    before, share = _between(places, len(rows) - 1)
    slope = rows[before + 1] - rows[before]
    return areas[before] + rows[before] * share + slope * (share * share / 2)


def _between(places: NDArray[np.float64], last: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the row before each place, and (as a column) the fraction of the distance to the next row."""
    before: NDArray[np.int64] = np.minimum(places.astype(np.int64), last - 1)
    return before, (places - before)[:, None]
