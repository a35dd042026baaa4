"""Ground from triangles: the heights of a surface at the points of the grid."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.world import CELL
from wildscav_engine.maps.base import BaseError

EDGE = 1e-6  # tolerance in barycentric coordinates for points outside a triangle


def ground_from(
    vertices: NDArray[np.float64], triangles: NDArray[np.int64], size: int
) -> tuple[NDArray[np.float64], float]:
    """Return the heights of a surface on the grid of a map, and the share of the grid that it covers.

    Args:
        vertices: (V, 3) m, in the frame of the map.
        triangles: (T, 3) vertices; of several above each other, the highest counts.
        size: m, of each side of the map.

    Returns:
        (R + 1, C + 1) m; outside the surface, the height of the nearest point on it. And the share.

    Raises:
        BaseError: The surface lies over no point of the grid.
    """
    from scipy.ndimage import distance_transform_edt

    points = round(size / CELL) + 1
    heights = np.full((points, points), -np.inf)
    _drape(vertices, triangles, -size / 2, heights)
    bare = heights == -np.inf
    if bare.all():
        raise BaseError("its ground lies over no part of the map")
    rows, columns = distance_transform_edt(bare, return_distances=False, return_indices=True)
    return heights[rows, columns], float(1.0 - bare.mean())


@kernel
def _drape(
    vertices: NDArray[np.float64], triangles: NDArray[np.int64], corner: float, heights: NDArray[np.float64]
) -> None:
    """Raise every point of the grid to the highest triangle at its position.

    Args:
        vertices: (V, 3) m.
        triangles: (T, 3) vertices.
        corner: m, x and z of the first point.
        heights: (R, C) m, raised.
    """
    rows, columns = heights.shape
    for number in range(triangles.shape[0]):
        a, b, c = triangles[number, 0], triangles[number, 1], triangles[number, 2]
        ax, ay, az = vertices[a, 0], vertices[a, 1], vertices[a, 2]
        bx, bz = vertices[b, 0] - ax, vertices[b, 2] - az
        cx, cz = vertices[c, 0] - ax, vertices[c, 2] - az
        twice_area = bx * cz - bz * cx
        if twice_area == 0.0:
            continue  # upright: it covers no area
        first_row = max(0, int(np.ceil((az + min(0.0, bz, cz) - corner) / CELL - EDGE)))
        last_row = min(rows - 1, int(np.floor((az + max(0.0, bz, cz) - corner) / CELL + EDGE)))
        first_column = max(0, int(np.ceil((ax + min(0.0, bx, cx) - corner) / CELL - EDGE)))
        last_column = min(columns - 1, int(np.floor((ax + max(0.0, bx, cx) - corner) / CELL + EDGE)))
        for row in range(first_row, last_row + 1):
            z = corner + row * CELL - az
            for column in range(first_column, last_column + 1):
                x = corner + column * CELL - ax
                share_b = (x * cz - z * cx) / twice_area
                share_c = (bx * z - bz * x) / twice_area
                if share_b >= -EDGE and share_c >= -EDGE and share_b + share_c <= 1.0 + EDGE:
                    height = ay + share_b * (vertices[b, 1] - ay) + share_c * (vertices[c, 1] - ay)
                    heights[row, column] = max(heights[row, column], height)
