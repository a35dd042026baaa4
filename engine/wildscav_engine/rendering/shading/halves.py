"""Half the pixels of a row: every second one of each piece of a surface, and the next one gets its colour.

Pieces are found among all pixels, so edges stay as sharp; only what is on surfaces is coarser.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel
from wildscav_engine.rendering.hits import Hits
from wildscav_engine.rendering.shading.pixel_rows import RowOfPixels
from wildscav_engine.rendering.tracing.frustum import nonnegative


class Half(NamedTuple):
    """Buffers for the chosen pixels of a row, (W,) each."""

    column: NDArray[np.int32]  # of the row
    solid: NDArray[np.int32]  # this and the next two as in ``Hits``
    face: NDArray[np.int32]  # only of the first of each piece
    distance: NDArray[np.float32]
    cosine: NDArray[np.float32]  # of the angle between the ray and the view axis


@inlined_kernel
def half_in(integers: NDArray[np.int32], floats: NDArray[np.float32]) -> Half:
    """Return the buffers in (3, W) and (2, W) numbers."""
    return Half(integers[0], integers[1], integers[2], floats[0], floats[1])


@disjoint_kernel
def halve(line: Hits, cosines: NDArray[np.float32], pieces: NDArray[np.int32], count: int, half: Half) -> int:
    """Choose pixels, and return how many; ``count`` pieces then begin and end among them.

    Args:
        line: What the rays of the row hit, (W,) each.
        cosines: (W,) of their angles to the view axis.
    """
    chosen, first = 0, 0
    for piece in range(count):
        last = pieces[piece + 1]
        pieces[piece] = chosen
        half.face[nonnegative(chosen)] = line.face[nonnegative(first)]
        for number in range((last + 1 - first) >> 1):
            at, column = nonnegative(chosen) + number, nonnegative(first) + 2 * number
            half.column[at], half.solid[at] = column, line.solid[first]
            half.distance[at], half.cosine[at] = line.distance[column], cosines[column]
        chosen += (last + 1 - first) >> 1
        first = last
    pieces[count] = chosen
    return chosen


@inlined_kernel
def spread_colors(pixels: RowOfPixels, columns: NDArray[np.int32], colors: NDArray[np.uint8]) -> None:
    """Write (W, 3) the colours of a row, given those of its chosen pixels."""
    red, green, blue = pixels.color
    last = colors.shape[0] - 1
    for at in range(red.shape[0]):
        r, g, b = np.int32(red[at]), np.int32(green[at]), np.int32(blue[at])
        column = nonnegative(columns[at])
        beside = nonnegative(min(last, column + 1))  # another chosen pixel then writes its own colour there
        colors[beside, 0], colors[beside, 1], colors[beside, 2] = r, g, b
        colors[column, 0], colors[column, 1], colors[column, 2] = r, g, b
