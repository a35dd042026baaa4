"""The pieces of a row of pixels, each of which shows one surface."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel
from wildscav_engine.geometry.rays import TERRAIN_HIT
from wildscav_engine.rendering.tracing.frustum import nonnegative

AT_ONCE = 16  # pixels that are compared at once


@disjoint_kernel
def find_pieces(solids: NDArray[np.int32], faces: NDArray[np.int32], pieces: NDArray[np.int32]) -> int:
    """Find the pieces of a row, given what its W rays hit, as in ``Hits``; return how many there are.

    ``pieces``, (W + 1,), gets the first column of each, then the column after the last.
    """
    width, count = solids.shape[0], 1
    pieces[0] = 0
    for start in range(1, width, AT_ONCE):
        end = min(width, start + AT_ONCE)
        if _is_one_surface(solids[start - 1 : end], faces[start - 1 : end]):
            continue
        for column in range(start, end):
            # Always written, counted only if it begins a piece: this avoids branches.
            pieces[nonnegative(count)] = column
            is_other_face = (faces[column] != faces[column - 1]) & (solids[column] != TERRAIN_HIT)
            count += (solids[column] != solids[column - 1]) | is_other_face
    pieces[nonnegative(count)] = width
    return count


@disjoint_kernel
def _is_one_surface(solids: NDArray[np.int32], faces: NDArray[np.int32]) -> bool:
    """Return whether successive pixels all show one surface, in a loop that vectorizes."""
    is_other = np.int32(0)
    for column in range(1, solids.shape[0]):
        is_other_face = np.int32(faces[column] != faces[0]) & np.int32(solids[0] != TERRAIN_HIT)
        is_other |= np.int32(solids[column] != solids[0]) | is_other_face
    return bool(is_other == 0)
