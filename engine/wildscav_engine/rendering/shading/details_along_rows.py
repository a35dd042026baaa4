"""Where the pixels of a row are on surfaces, how large they are there, and which details they show."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel
from wildscav_engine.rendering.shading.pixel_rays import LEAST_FACING, View, Ways
from wildscav_engine.rendering.shading.pixel_rows import Normals
from wildscav_engine.rendering.shading.surfaces import BLUR, SHARPEST
from wildscav_engine.rendering.shading.texture_scratch import TextureScratch

NONE, ONE = np.float32(0.0), np.float32(1.0)
SHARPEST_32, BLUR_32, LEAST_FACING_32 = np.float32(SHARPEST), np.float32(BLUR), np.float32(LEAST_FACING)


@disjoint_kernel
def write_places(view: View, ways: Ways, distances: NDArray[np.float32], scratch: TextureScratch) -> None:
    """Write where the pixels of a piece of a row show something."""
    x, y, z = np.float32(view.eye[0]), np.float32(view.eye[1]), np.float32(view.eye[2])
    for column in range(distances.shape[0]):
        scratch.x[column] = x + ways.east[column] * distances[column]
        scratch.y[column] = y + ways.up[column] * distances[column]
        scratch.z[column] = z + ways.north[column] * distances[column]


@disjoint_kernel
def write_footprints(
    view: View, ways: Ways, distances: NDArray[np.float32], normal: Normals, scratch: TextureScratch
) -> None:
    """Write the sizes of pixels on surfaces with these normals, as ``pixel_rays.footprint`` does."""
    pixel = np.float32(view.pixel)
    for column in range(distances.shape[0]):
        away = ways.east[column] * normal.east[column] + ways.up[column] * normal.up[column]
        facing = -(away + ways.north[column] * normal.north[column])
        scratch.pixel[column] = pixel * distances[column] / max(LEAST_FACING_32, facing)


@inlined_kernel
def sharpness32(size: np.float32, pixel: np.float32) -> np.float32:
    """Return how visible a detail of some size in m is, 0-1, at a pixel size in m."""
    return min(ONE, max(NONE, SHARPEST_32 - pixel * (BLUR_32 / size)))


@disjoint_kernel
def write_seen(
    size: np.float32, strength: np.float32, count: int, pixel: NDArray[np.float32], seen: NDArray[np.float32]
) -> bool:
    """Write how visible details of some size are; return whether any is."""
    is_any = np.int32(0)
    for column in range(count):
        sharp = sharpness32(size, pixel[column])
        seen[column] = strength * sharp
        is_any |= np.int32(sharp > NONE)
    return bool(is_any != 0)
