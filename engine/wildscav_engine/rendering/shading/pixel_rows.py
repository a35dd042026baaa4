"""What is computed for one row of pixels, and space for it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.rendering.shading.pixel_rays import Ways

ROWS = 21  # of numbers that a row of pixels needs
COLOR, UNOCCLUDED, NORMAL, TILT, PLACE, OTHERS = 3, 6, 8, 11, 14, 17  # the first row of each


class Channels(NamedTuple):
    """Red, green and blue of a row, 0-255, (W,) each."""

    red: NDArray[np.float32]
    green: NDArray[np.float32]
    blue: NDArray[np.float32]


class Normals(NamedTuple):
    """The unit normals of the surfaces of a row, (W,) each."""

    east: NDArray[np.float32]
    up: NDArray[np.float32]
    north: NDArray[np.float32]


class Tilts(NamedTuple):
    """The planes of the surfaces of a row on the camera's axes, (W,) each."""

    right: NDArray[np.float32]  # parts of the normals
    above: NDArray[np.float32]
    facing: NDArray[np.float32]  # m of a plane from the eye per m along the view axis


class Places(NamedTuple):
    """Where rays to the light start, slightly off the surfaces of a row, (W,) m each."""

    x: NDArray[np.float32]
    y: NDArray[np.float32]
    z: NDArray[np.float32]


class RowOfPixels(NamedTuple):
    """What is computed for one row of pixels, (W,) each."""

    ways: Ways
    color: Channels  # of the surfaces, first without light, then without haze
    normal: Normals
    tilt: Tilts
    place: Places
    unoccluded: NDArray[np.float32]  # share of the light from the sky that nearby surfaces leave
    unoccluded_above: NDArray[np.float32]  # the same in the row above
    ambient: NDArray[np.float32]  # light on surfaces from the sky
    direct: NDArray[np.float32]  # light on surfaces from the sun
    fog: NDArray[np.float32]  # share of the haze in the final colour
    level: NDArray[np.float32]  # how near rays are to the horizon, 0-1


def allocate_rows(width: int) -> NDArray[np.float32]:
    """Return uninitialized space for a row of pixels and what it needs of the one above."""
    return np.empty((ROWS, width), np.float32)


@inlined_kernel
def row_in(space: NDArray[np.float32], row: int) -> RowOfPixels:
    """Return the arrays of a row."""
    this, above = space[UNOCCLUDED + (row & 1)], space[UNOCCLUDED + 1 - (row & 1)]
    return RowOfPixels(
        Ways(space[0], space[1], space[2]),
        Channels(space[COLOR], space[COLOR + 1], space[COLOR + 2]),
        Normals(space[NORMAL], space[NORMAL + 1], space[NORMAL + 2]),
        Tilts(space[TILT], space[TILT + 1], space[TILT + 2]),
        Places(space[PLACE], space[PLACE + 1], space[PLACE + 2]),
        this,
        above,
        space[OTHERS],
        space[OTHERS + 1],
        space[OTHERS + 2],
        space[OTHERS + 3],
    )
