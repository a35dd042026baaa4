"""The depth map of the followed agent, in the colours of ``wildscav map look`` and with a scale beneath it.

It is an image with one byte per pixel, an index into the colours. The viewer shows the distance of the pixel
under the pointer.
"""

from collections.abc import Iterator

import numpy as np
import rerun as rr
from numpy.typing import NDArray
from rerun.components import ImageFormat
from rerun.encodings import ChannelDatatype

from wildscav_engine.sensors.display.colors import distance_colors
from wildscav_engine.view.recording.columns import Columns, blocks
from wildscav_engine.view.recording.history import DEPTH_CAMERA, ImageSequence

DEPTH = "follow/depth"
SHADES = 256
FAR = DEPTH_CAMERA.far
TICKS = (0, 5, 20, 50, 100, 200)  # m
BAR, BELOW, TEXT = (
    1.5,
    3.5,
    7.0,
)  # pixels: half the bar's height; distance of bar and numbers from the image
SCALE_HEIGHT = 12.0  # pixels, the total height of the scale


def shades_of(distances: NDArray[np.floating]) -> NDArray[np.uint8]:
    """Return the index of the shade of each distance in m, which grows with its square root."""
    share = np.sqrt(np.clip(distances / FAR, 0.0, 1.0))
    return np.asarray(np.round(share * (SHADES - 1)), np.uint8)


def distances_of(shades: NDArray[np.integer]) -> NDArray[np.float64]:
    """Return the distance in m of each shade."""
    return np.asarray((shades / (SHADES - 1)) ** 2 * FAR)


def static_depth() -> Iterator[tuple[str, rr.AsComponents]]:
    """Yield the meaning of the shades, and the scale."""
    metres = distances_of(np.arange(SHADES))
    tints = distance_colors(metres[None], FAR)[0].tolist()
    shades = [
        rr.AnnotationInfo(id=shade, label=f"{distance:.1f} m", color=tuple(tint))
        for shade, (distance, tint) in enumerate(zip(metres.tolist(), tints, strict=True))
    ]
    yield DEPTH, rr.AnnotationContext(shades)
    image = ImageFormat(DEPTH_CAMERA.width, DEPTH_CAMERA.height, channel_datatype=ChannelDatatype.U8)
    yield DEPTH, rr.SegmentationImage.from_fields(format=image, opacity=1.0)
    yield f"{DEPTH}/scale/colors", _bar(tints)
    yield f"{DEPTH}/scale/numbers", _numbers()


def _bar(tints: list[list[int]]) -> rr.LineStrips2D:
    """Return the colours from near to far as a bar as wide as the image."""
    ends = np.linspace(BAR, DEPTH_CAMERA.width - BAR, len(tints) + 1)
    level = np.full(len(tints), DEPTH_CAMERA.height + BELOW)
    strips = np.stack([np.stack([ends[side : side + len(tints)], level], axis=-1) for side in (0, 1)], axis=1)
    return rr.LineStrips2D(strips, colors=tints, radii=BAR)


def _numbers() -> rr.Points2D:
    positions = [(DEPTH_CAMERA.width * np.sqrt(metres / FAR), DEPTH_CAMERA.height + TEXT) for metres in TICKS]
    labels = [f"{metres} m" if metres == TICKS[-1] else f"{metres}" for metres in TICKS]
    return rr.Points2D(positions, labels=labels, show_labels=True, radii=0.0, colors=[(128, 128, 128)])


def moving_depth(depth: ImageSequence) -> Iterator[Columns]:
    """Yield the depth maps."""
    flat = shades_of(depth.images).reshape(len(depth.images), -1)
    for block in blocks(len(flat)):
        yield Columns(DEPTH, depth.rows[block], rr.SegmentationImage.columns(buffer=flat[block]))
