"""Markers on an image from above: an arrowhead for each agent in its team's colour and view direction."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.rendering.palette import of_seat
from wildscav_engine.simulation.state import Agents

SIZE = 0.022  # of the image's longer side, from an arrowhead's center to its tip
MIN_SIZE = 5.0  # pixels
RIM = 1.6  # pixels, width of a dark rim that makes the marker visible on any ground
# Corners relative to the center, to the right and ahead, in units of the distance to the tip.
ARROWHEAD = ((0.0, 1.0), (0.75, -0.8), (0.0, -0.4), (-0.75, -0.8))
DARK = (20, 20, 20)


def mark_agents(picture: NDArray[np.uint8], agents: Agents, height: float, *, tangent_of_half: float) -> None:
    """Mark the living agents of one match, in place.

    Args:
        picture: (height, width, 3) from a camera above the center of the map, north at the top.
        agents: With a leading axis of length one.
        height: m, height of the camera.
        tangent_of_half: The tangent of half the camera's horizontal angle of view.
    """
    rows, columns = picture.shape[:2]
    size = max(MIN_SIZE, SIZE * max(rows, columns))
    for seat in np.flatnonzero(agents.health[0] > 0).tolist():
        x, y, z = agents.position[0, seat].tolist()
        scale = columns / 2 / (tangent_of_half * (height - y))  # pixels per metre
        center = (columns / 2 + x * scale, rows / 2 - z * scale)
        yaw = float(agents.yaw[0, seat])
        _fill(picture, _corners(center, yaw, size + RIM), DARK)
        _fill(picture, _corners(center, yaw, size), of_seat(int(agents.team[0, seat])))


def _corners(center: tuple[float, float], yaw: float, size: float) -> NDArray[np.float64]:
    """Return (4, 2) the corners of an arrowhead, in pixels to the right and down."""
    ahead = np.array([sine(yaw), -cosine(yaw)])
    right = np.array([-ahead[1], ahead[0]])
    return np.array(
        [np.array(center) + size * (across * right + along * ahead) for across, along in ARROWHEAD]
    )


def _fill(picture: NDArray[np.uint8], corners: NDArray[np.float64], color: tuple[int, int, int]) -> None:
    """Fill the two triangles on either side of an arrowhead's axis, clipped to the image."""
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
        edge = end - start
        sides.append(edge[0] * (down - start[1]) - edge[1] * (across - start[0]) >= 0.0)
    inside: NDArray[np.bool_] = np.equal(sides[0], sides[1]) & np.equal(sides[1], sides[2])  # all on one side
    return inside
