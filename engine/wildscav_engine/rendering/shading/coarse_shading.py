"""Coarse shading: up to two by two pixels that show the same surface share one colour.

In even rows, every second pixel of each piece of a surface is shaded; in odd ones, only pixels that show
another surface than those above. So edges stay as sharp as with all pixels, and only what is on surfaces is
coarser. Graphics processors call this variable-rate shading.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel
from wildscav_engine.geometry.rays import TERRAIN_HIT
from wildscav_engine.rendering.hits import Hits, is_same_surface
from wildscav_engine.rendering.shading.pixel_rows import RowOfPixels
from wildscav_engine.rendering.tracing.frustum import nonnegative

COMPARED = 16  # pixels that are compared at once


class Chosen(NamedTuple):
    """Buffers for the pixels of a row that are shaded, (W,) each."""

    column: NDArray[np.int32]  # of the row
    beside: NDArray[np.int32]  # the column that gets the same colour
    solid: NDArray[np.int32]  # this and the next two as in ``Hits``
    face: NDArray[np.int32]  # only of the first of each piece
    distance: NDArray[np.float32]
    cosine: NDArray[np.float32]  # of the angle between the ray and the view axis


@disjoint_kernel
def choose_half(
    line: Hits, cosines: NDArray[np.float32], pieces: NDArray[np.int32], count: int, chosen: Chosen
) -> int:
    """Choose pixels, and return how many; ``count`` pieces then begin and end among them.

    Args:
        line: What the rays of the row hit, (W,) each.
        cosines: (W,) of their angles to the view axis.
    """
    many, first = 0, 0
    for piece in range(count):
        last = pieces[piece + 1]
        pieces[piece] = many
        many, first = _choose(line, cosines, first, last, many, chosen), last
    pieces[count] = many
    return many


@disjoint_kernel
def choose_unlike(
    line: Hits, over: Hits, cosines: NDArray[np.float32], pieces: NDArray[np.int32], chosen: Chosen
) -> tuple[int, int]:
    """Choose pixels that show another surface than those above; return how many pieces and pixels these are.

    Args:
        line: What the rays of the row hit, (W,) each.
        over: What those of the row above hit.
        cosines: (W,) of the rays' angles to the view axis.
        pieces: Written: where each piece begins among the chosen pixels, and their number.
    """
    width, count, many, first = line.solid.shape[0], 0, 0, 0
    while first < width:
        if first % COMPARED == 0 and _are_like(line, over, first, min(width, first + COMPARED)):
            first += COMPARED
            continue
        last = first
        while last < width and _is_like(line, first, line, last) and not _is_like(line, last, over, last):
            last += 1
        if last > first:
            pieces[nonnegative(count)] = many
            many, count = _choose(line, cosines, first, last, many, chosen), count + 1
        first = max(last, first + 1)
    pieces[nonnegative(count)] = many
    return count, many


@inlined_kernel
def _choose(
    line: Hits, cosines: NDArray[np.float32], first: int, last: int, many: int, chosen: Chosen
) -> int:
    """Choose every second pixel of a piece after those that are chosen already; return how many all are."""
    more = (last + 1 - first) >> 1
    chosen.face[nonnegative(many)] = line.face[nonnegative(first)]
    for number in range(more):
        at, column = nonnegative(many) + number, nonnegative(first) + 2 * number
        chosen.column[at], chosen.beside[at] = column, min(last - 1, column + 1)
        chosen.solid[at] = line.solid[nonnegative(first)]
        chosen.distance[at], chosen.cosine[at] = line.distance[column], cosines[column]
    return many + more


@inlined_kernel
def _is_like(line: Hits, column: int, other: Hits, other_column: int) -> bool:
    """Return whether two pixels show the same face of a solid, or both the ground."""
    at, there = nonnegative(column), nonnegative(other_column)
    return is_same_surface(line.solid[at], line.face[at], other.solid[there], other.face[there])


@inlined_kernel
def _are_like(line: Hits, over: Hits, first: int, last: int) -> bool:
    """Return whether successive pixels all show the same as those above, in a loop that vectorizes."""
    is_other = np.int32(0)
    for column in range(nonnegative(first), last):
        is_other_face = np.int32(line.face[column] != over.face[column])
        is_other_face &= np.int32(line.solid[column] != TERRAIN_HIT)
        is_other |= np.int32(line.solid[column] != over.solid[column]) | is_other_face
    return bool(is_other == 0)


@inlined_kernel
def repeat_row(image: NDArray[np.uint8], row: int) -> None:
    """Copy the colours of the row above."""
    size = 3 * image.shape[1]
    _copy(image[row - 1].reshape(size), image[row].reshape(size))


@disjoint_kernel
def _copy(colors: NDArray[np.uint8], copies: NDArray[np.uint8]) -> None:
    for at in range(copies.shape[0]):
        copies[at] = colors[at]


@inlined_kernel
def spread_colors(pixels: RowOfPixels, chosen: Chosen, colors: NDArray[np.uint8]) -> None:
    """Write the colours of the chosen pixels of a row, and of those beside them, into (W, 3) of all."""
    red, green, blue = pixels.color
    for at in range(red.shape[0]):
        r, g, b = np.int32(red[at]), np.int32(green[at]), np.int32(blue[at])
        column, beside = nonnegative(chosen.column[at]), nonnegative(chosen.beside[at])
        colors[beside, 0], colors[beside, 1], colors[beside, 2] = r, g, b
        colors[column, 0], colors[column, 1], colors[column, 2] = r, g, b
