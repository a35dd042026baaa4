"""The cameras that follow one agent, from above and at its eyes, and the images of its own cameras.

Its depth map has the colours of ``wildscav map look``, and a scale beneath it. It is an image of one byte a
pixel, an index into the colours; the viewer shows the distance of the pixel under the pointer.
"""

from collections.abc import Iterator
from io import BytesIO

import numpy as np
import rerun as rr
from numpy.typing import NDArray
from PIL import Image
from rerun.components import ImageFormat
from rerun.encodings import ChannelDatatype

from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.sensors.display.colors import distance_colors
from wildscav_engine.view.recording import camera_poses, coordinates
from wildscav_engine.view.recording.columns import Columns, blocks
from wildscav_engine.view.recording.history import DEPTH_CAMERA, History, ImageSequence

DEPTH = "follow/depth"
SHADES = 256
FAR = DEPTH_CAMERA.far
TICKS = (0, 5, 20, 50, 100, 200)  # m
# Pixels: half the bar's height; distance of bar and numbers from the image.
BAR, BELOW, TEXT = 1.5, 3.5, 7.0
SCALE_HEIGHT = 12.0  # pixels, the total height of the scale
ABOVE, EYES, COLOR = "follow/above", "follow/eyes", "follow/color"
ANGLES = {ABOVE: 70.0, EYES: 75.0}  # degrees horizontally
JPEG_QUALITY = 80
# The outline of a camera, so close to it that it is invisible in the view through the camera.
OUTLINE = 1e-4  # m


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


def static_cameras(history: History) -> Iterator[tuple[str, rr.AsComponents]]:
    """Yield the static components of the cameras."""
    for camera in ANGLES:
        yield camera, _lens(camera)
    if history.depth is not None:
        yield from static_depth()
    if history.color is not None:
        yield COLOR, rr.EncodedImage.from_fields(media_type="image/jpeg")


def _lens(camera: str) -> rr.Pinhole:
    width, height = DEPTH_CAMERA.width, DEPTH_CAMERA.height
    return rr.Pinhole(
        resolution=(width, height),
        focal_length=float(width / 2 / np.tan(np.radians(ANGLES[camera]) / 2)),
        camera_xyz=rr.ViewCoordinates.RDF,
        image_plane_distance=OUTLINE,
        line_width=0.0,
    )


def moving_cameras(game_map: GameMap, history: History, seat: int) -> Iterator[Columns]:
    """Yield the poses of the cameras, and the images of the agent's own cameras."""
    yield _moving(ABOVE, history, camera_poses.above(game_map.world, history.agents, seat))
    yield _moving(EYES, history, camera_poses.at_the_eyes(history.agents, seat))
    if history.depth is not None:
        yield from moving_depth(history.depth)
    if history.color is not None:
        yield from _color(history.color)


def _moving(camera: str, history: History, poses: camera_poses.Poses) -> Columns:
    transforms = rr.Transform3D.columns(
        translation=coordinates.points(poses.position),
        quaternion=coordinates.camera_rotations(poses.yaw, poses.pitch),
    )
    return Columns(camera, history.rows, transforms)


def _color(color: ImageSequence) -> Iterator[Columns]:
    pictures = [_jpeg(picture) for picture in color.images]
    for block in blocks(len(pictures)):
        yield Columns(COLOR, color.rows[block], rr.EncodedImage.columns(blob=pictures[block]))


def _jpeg(picture: NDArray[np.uint8]) -> bytes:
    """Return a (height, width, 3) image as JPEG, which takes a tenth of its bytes."""
    file = BytesIO()
    Image.fromarray(picture).save(file, "JPEG", quality=JPEG_QUALITY, subsampling="4:4:4")
    return file.getvalue()
