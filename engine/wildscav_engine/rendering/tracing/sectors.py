"""Sectors of a panorama, which are traced like the images of cameras that look around on the level.

The rays of a panorama are at equal angles, and the tangents of equal angles are not at equal distances. On
the image of a pinhole camera, columns of rays are farther apart at the sides; rings are farther apart at the
top and bottom, and rise or fall towards the sides. So a sector has optics of its own, see ``Camera``.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

WIDEST = 36.0  # degrees of one sector; wide ones select more rays in vain, more of them repeat more work
BESIDE = (
    1.0  # columns that a sector is wider than its rays on either side, so that clear misses count as such
)
ALOFT = 1e-6  # tangents that it is higher, to allow for rounding
SINGLE = 50.0  # columns or rows per radian where there is only one, and any number would do


class Optics(NamedTuple):
    """The numbers of the camera that sees one sector; see ``Camera``."""

    scale: float
    curve: float
    scale_up: float
    spread: float
    level: float
    half_width: float
    half_height: float
    margin: float
    margin_up: float


class Sectors(NamedTuple):
    """A panorama in S sectors of N columns; the last may reach into the first."""

    number: int  # S
    columns: int  # N
    optics: Optics


def divide(azimuths: int, elevations: NDArray[np.float64]) -> Sectors:
    """Divide a panorama into sectors of equal size.

    Args:
        elevations: (C,) degrees above the horizon of its rings, at equal distances, the highest first; none
            points straight up or down.
    """
    number = -(-azimuths // max(1, int(azimuths * WIDEST / 360.0)))
    columns = -(-azimuths // number)
    angle = 2.0 * np.pi / azimuths
    places = np.arange(columns) - (columns - 1) / 2.0
    right = np.tan(places * angle)
    scale, curve = _scale_of(places, right)
    margin = np.abs(scale * right + curve * right**3 - places).max()
    side = np.cos(places[-1] * angle)
    half_width = right[-1] + BESIDE / (scale + 3.0 * curve * right[-1] ** 2)
    scale_up, spread, level, margin_up = _rows_of(np.radians(elevations), float(side))
    half_height = np.tan(np.radians(np.abs(elevations).max())) / side + ALOFT
    optics = Optics(
        float(scale),
        float(curve),
        scale_up,
        spread,
        level,
        float(half_width),
        float(half_height),
        float(margin),
        margin_up,
    )
    return Sectors(number, columns, optics)


def _scale_of(places: NDArray[np.floating], right: NDArray[np.floating]) -> tuple[float, float]:
    """Return the scale and the curve that fit columns best, given their places and their tangents."""
    if len(places) == 1:
        return SINGLE, 0.0
    if len(places) == 2:
        return float(places[1] / right[1]), 0.0
    scale, curve = np.linalg.lstsq(np.stack([right, right**3], axis=1), places, rcond=None)[0]
    return float(scale), float(curve)


def _rows_of(elevations: NDArray[np.float64], side: float) -> tuple[float, float, float, float]:
    """Return the scale upwards, the spread, the level and the margin upwards.

    Args:
        elevations: (C,) radians.
        side: The cosine of the angle between the middle and the side of the sector.
    """
    span = float(elevations[0] - elevations[-1])
    per_radian = (len(elevations) - 1) / span if span > 0.0 else SINGLE
    # Over the tangent upwards on the image, the angle is 1 for a level ray, and least for the steepest at the
    # side.
    steepest = float(np.abs(elevations).max())
    least = side * steepest / np.tan(steepest) if steepest > 0.0 else side
    scale_up, spread = per_radian * (1.0 + least) / 2.0, per_radian * (1.0 - least) / 2.0
    margin = 0.0 if span > 0.0 else len(elevations) - 1.0  # All rings may be at the same place.
    return float(scale_up), float(spread), float(elevations[0] * per_radian) + 0.5, margin
