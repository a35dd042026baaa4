"""Screen-space ambient occlusion: less light in corners, where a wall meets a floor or a foot the ground.

It uses what nearby pixels hit, so it casts no rays. After Mittring, "Finding Next Gen: CryEngine 2", SIGGRAPH
2007 courses.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.rendering.shading.color_arithmetic import Vector, dot
from wildscav_engine.rendering.shading.pixel_rays import View, point_along
from wildscav_engine.rendering.trace import Hits

REACH = 0.5  # m, up to which other surfaces occlude
STRENGTH = 0.65
LEAST_RISE = 0.12  # sine of the angle above a surface below which nothing occludes it
# Rows and columns of the sampled pixels, in shares of the reach.
SAMPLES = np.array(
    [(0, 1), (0, -1), (1, 0), (-1, 0), (0.35, 0.35), (0.35, -0.35), (-0.35, 0.35), (-0.35, -0.35)], np.float64
)


@inlined_kernel
def unoccluded_share(
    hits: Hits,
    image: int,
    row: int,
    column: int,
    view: View,
    directions: NDArray[np.float64],
    place: Vector,
    normal: Vector,
) -> float:
    """Return the share of ambient light at a surface that nearby surfaces do not occlude, 0-1.

    Args:
        hits: What all rays hit.
        image: Index of the image.
        row: Of the pixel.
        column: Of the pixel.
        view: The camera of the image.
        directions: (H, W, 3) unit vectors of its rays.
        place: m, the point that the pixel shows.
        normal: Unit normal of the surface there.
    """
    distance = float(hits.distance[image, row, column])
    reach = min(REACH / max(1e-6, distance * view.pixel), 0.2 * view.height)
    if reach < 1.0:
        return 1.0
    taken = 0.0
    for sample in range(SAMPLES.shape[0]):
        down, right = SAMPLES[sample, 0] * reach, SAMPLES[sample, 1] * reach
        other_row = min(view.height - 1, max(0, int(row + down + 0.5)))
        other_column = min(view.width - 1, max(0, int(column + right + 0.5)))
        other = float(hits.distance[image, other_row, other_column])
        if other == np.inf:
            continue
        direction = directions[other_row, other_column]
        there = point_along(view.eye, (direction[0], direction[1], direction[2]), other)
        aside = (there[0] - place[0], there[1] - place[1], there[2] - place[2])
        height = dot(aside, normal)
        if height <= 0.0:
            continue
        length = np.sqrt(dot(aside, aside))
        if length < 2.0 * REACH:
            rise = max(0.0, height / length - LEAST_RISE)
            taken += rise * (1.0 - length / (2.0 * REACH))
    return max(0.0, 1.0 - STRENGTH * taken * 0.25 * min(1.0, reach - 1.0))
