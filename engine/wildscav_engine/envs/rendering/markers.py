"""Marks on a picture from above: an arrowhead for each agent, in its team's colour, to where it looks."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.rendering.palette import of_seat
from wildscav_engine.simulation.state import Agents

SHARE = 0.022  # of the picture's longer side: from an arrowhead's middle to its tip
LEAST = 5.0  # pixels, the same
RIM = 1.6  # pixels of a dark rim, so that it shows on any ground
# Corners from the middle, to the right and ahead, as parts of the way to the tip.
ARROWHEAD = ((0.0, 1.0), (0.75, -0.8), (0.0, -0.4), (-0.75, -0.8))
DARK = (20, 20, 20)


def mark_agents(picture: NDArray[np.uint8], agents: Agents, height: float, *, tangent_of_half: float) -> None:
    """Mark the living agents of one match, in place.

    Args:
        picture: (height, width, 3) of a camera above the middle of the map, looking down, north up.
        agents: With a leading axis of length one.
        height: m, of the camera.
        tangent_of_half: Of half the camera's angle from the left edge to the right.
    """
    rows, columns = picture.shape[:2]
    size = max(LEAST, SHARE * max(rows, columns))
    for seat in np.flatnonzero(agents.health[0] > 0).tolist():
        x, y, z = agents.position[0, seat].tolist()
        scale = columns / 2 / (tangent_of_half * (height - y))  # pixels a metre
        middle = (columns / 2 + x * scale, rows / 2 - z * scale)
        yaw = float(agents.yaw[0, seat])
        _fill(picture, _corners(middle, yaw, size + RIM), DARK)
        _fill(picture, _corners(middle, yaw, size), of_seat(int(agents.team[0, seat])))


def _corners(middle: tuple[float, float], yaw: float, size: float) -> NDArray[np.float64]:
    """Return (4, 2) the corners of an arrowhead, pixels to the right and down."""
    ahead = np.array([sine(yaw), -cosine(yaw)])
    right = np.array([-ahead[1], ahead[0]])
    return np.array(
        [np.array(middle) + size * (across * right + along * ahead) for across, along in ARROWHEAD]
    )


def _fill(picture: NDArray[np.uint8], corners: NDArray[np.float64], color: tuple[int, int, int]) -> None:
    """Paint the two triangles on either side of an arrowhead's axis, as far as they are in the picture."""
    rows, columns = picture.shape[:2]
    left, top = np.clip(np.floor(corners.min(axis=0)).astype(int), 0, (columns, rows))
    right, bottom = np.clip(np.ceil(corners.max(axis=0)).astype(int) + 1, 0, (columns, rows))
    across, down = np.meshgrid(np.arange(left, right) + 0.5, np.arange(top, bottom) + 0.5)
    tip, one, notch, other = corners
    inside = _in_triangle(across, down, tip, one, notch) | _in_triangle(across, down, tip, notch, other)
    picture[top:bottom, left:right][inside] = color


def _in_triangle(
    across: NDArray[np.float64], down: NDArray[np.float64], *corners: NDArray[np.float64]
) -> NDArray[np.bool_]:
    sides = []
    for start, end in zip(corners, (*corners[1:], corners[0]), strict=True):
        way = end - start
        sides.append(way[0] * (down - start[1]) - way[1] * (across - start[0]) >= 0.0)
    inside: NDArray[np.bool_] = np.equal(sides[0], sides[1]) & np.equal(sides[1], sides[2])  # all on one side
    return inside
