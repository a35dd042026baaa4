"""What stands around a seat, as text: how far each direction is free, and what is in view."""

import numpy as np
from numpy.typing import NDArray

from wildscav.skills.surroundings import Rings
from wildscav_language.body import Body
from wildscav_language.phrases import clock, degrees
from wildscav_language.senses import FIELD_OF_VIEW

REACH = 20.0  # m, within which obstacles are told
STEEP = 1.0  # rise over run, from which on nothing walks up: 45 degrees
STEP = 0.5  # m above the soles, that are walked over
HEAD = 1.8  # m above the soles
EYES = 1.5  # m above the soles
BLOCKED = 0.75  # of the rays of an hour, that an obstacle must stop to block it
KINDS = {
    2: "water",
    3: "walls of a building",
    5: "stairs",
    7: "tree trunks",
    9: "rocks",
    10: "furniture",
    11: "bushes",
}  # of the sensor segmentation that are told
OTHERS = {12: "agents", 13: "supply boxes"}  # that are told unless only pictures show them


def around(body: Body) -> str:
    """Return how far each hour of the clock is free of obstacles; nothing without a LIDAR."""
    reading = body.now.tensors.get("lidar")
    if reading is None:
        return ""
    ways = obstacles(reading, body.gathering.rings)
    told = []
    for hour in range(12):
        middle = round(hour * len(ways) / 12)
        half = len(ways) // 24
        sector = np.take(ways, range(middle - half, middle + half), mode="wrap")
        if float(sector.min()) < REACH:
            told.append(f"{hour or 12} o'clock {_said_of(sector)}")
    where = f"{'; '.join(told)}; free elsewhere" if told else "none"
    return f"Obstacles within {REACH:.0f} m: {where}."


def _said_of(sector: NDArray[np.float64]) -> str:
    """Return what the rays of an hour show, (rays,) m, if they show anything."""
    nearest = float(sector.min())
    share = float((sector < min(REACH, 1.5 * nearest + 1.0)).mean())
    return f"{'blocked' if share >= BLOCKED else 'something'} at {nearest:.0f} m"


def obstacles(reading: NDArray[np.float32], rings: Rings) -> NDArray[np.float64]:
    """Return how far away the first steep thing at the height of a body is, (azimuths,) m; inf for none.

    Args:
        reading: (channels, azimuths) m, the highest ring first.
        rings: The options of the LIDAR.
    """
    up = np.radians(np.linspace(rings.highest, rings.lowest, reading.shape[0]))[:, None]
    way, height = reading * np.cos(up), reading * np.sin(up) + EYES
    hit = reading < rings.range * 0.999
    rise, run = height[:-1] - height[1:], np.abs(way[:-1] - way[1:])
    steep = hit[:-1] & hit[1:] & (rise > STEEP * run) & (height[:-1] > STEP) & (height[1:] < HEAD)
    nearest: NDArray[np.float64] = np.where(steep, np.minimum(way[:-1], way[1:]), np.inf).min(axis=0)
    return nearest


def in_view(body: Body) -> str:
    """Return what the view shows; nothing without the sensors segmentation and depth."""
    kinds, depth = body.now.tensors.get("segmentation"), body.now.tensors.get("depth")
    if kinds is None or depth is None:
        return ""
    offs = column_angles(kinds.shape[1])
    lines = []
    for kind, name in (KINDS if body.match.senses == "pixels" else KINDS | OTHERS).items():
        rows, columns = np.nonzero(kinds == kind)
        if len(rows):
            far = depth[rows, columns] / np.cos(np.radians(offs[columns]))
            nearest = int(np.argmin(far))
            off = float(offs[columns[nearest]])
            left, right = (degrees(body.now.yaw + float(offs[end])) for end in (columns.min(), columns.max()))
            span = f"from bearing {left} to {right}" if left != right else f"at bearing {left}"
            lines.append(f"- {name}: nearest {far[nearest]:.0f} m at {clock(off)}, {span}")
    return "\n".join(["In view:", *lines]) if lines else "In view: open country."


def column_angles(width: int) -> NDArray[np.float64]:
    """Return how far right of the view each column of the cameras is, (width,) degrees."""
    half = np.tan(np.radians(FIELD_OF_VIEW / 2.0))
    angles: NDArray[np.float64] = np.degrees(np.arctan(((np.arange(width) + 0.5) / width * 2.0 - 1.0) * half))
    return angles
