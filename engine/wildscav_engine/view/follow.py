"""The cameras that follow one agent: from behind, from its eyes, and its own two with what they see."""

from collections.abc import Iterator
from io import BytesIO

import numpy as np
import rerun as rr
from numpy.typing import NDArray
from PIL import Image
from rerun.components import ImageFormat
from rerun.encodings import ChannelDatatype

from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.view import cameras, frame
from wildscav_engine.view.columns import Columns, blocks
from wildscav_engine.view.history import DEPTH_CAMERA, Film, History

BEHIND, EYES, DEPTH, COLOR = "follow/behind", "follow/eyes", "follow/depth", "follow/color"
ANGLES = {BEHIND: 70.0, EYES: 75.0, DEPTH: 60.0}  # degrees wide; the depth sensor's is as it is
DEPTH_SHOWN = 60.0  # m, where the colours of the depth map end
DEPTH_UNITS = 250.0  # in a metre, so that 200 m fit into 16 bits
JPEG_QUALITY = 80


def static_cameras(history: History) -> Iterator[tuple[str, rr.AsComponents]]:
    """Yield what the cameras are like."""
    yield BEHIND, _lens(BEHIND)
    yield EYES, _lens(EYES)
    if history.depth is not None:
        height, width = history.depth.images.shape[1:]
        yield DEPTH, _lens(DEPTH)
        yield (
            DEPTH,
            rr.DepthImage.from_fields(
                format=ImageFormat(width, height, channel_datatype=ChannelDatatype.U16),
                meter=DEPTH_UNITS,
                colormap="turbo",
                depth_range=(0, DEPTH_SHOWN * DEPTH_UNITS),
            ),
        )
    if history.color is not None:
        yield COLOR, rr.EncodedImage.from_fields(media_type="image/jpeg")


def _lens(camera: str) -> rr.Pinhole:
    """A pinhole; its outline is hardly drawn, for it would frame the view through it."""
    width, height = DEPTH_CAMERA.width, DEPTH_CAMERA.height
    return rr.Pinhole(
        resolution=(width, height),
        focal_length=float(width / 2 / np.tan(np.radians(ANGLES[camera]) / 2)),
        camera_xyz=rr.ViewCoordinates.RDF,
        image_plane_distance=0.5,
        line_width=0.0,
    )


def moving_cameras(game_map: GameMap, history: History, seat: int) -> Iterator[Columns]:
    """Yield where the cameras are, and what the agent's own see."""
    eyes = cameras.at_the_eyes(history.agents, seat)
    yield _moving(BEHIND, history, cameras.behind(game_map.world, history.agents, seat))
    yield _moving(EYES, history, eyes)
    if history.depth is not None:
        yield _moving(DEPTH, history, eyes)
        yield from _depth(history.depth)
    if history.color is not None:
        yield from _color(history.color)


def _moving(camera: str, history: History, poses: cameras.Poses) -> Columns:
    transforms = rr.Transform3D.columns(
        translation=frame.points(poses.position),
        quaternion=frame.camera_rotations(poses.yaw, poses.pitch),
    )
    return Columns(camera, history.rows, transforms)


def _depth(depth: Film) -> Iterator[Columns]:
    pixels = np.round(depth.images * DEPTH_UNITS).astype(np.uint16)
    flat = pixels.view(np.uint8).reshape(len(pixels), -1)
    for block in blocks(len(flat)):
        yield Columns(DEPTH, depth.rows[block], rr.DepthImage.columns(buffer=flat[block]))


def _color(color: Film) -> Iterator[Columns]:
    pictures = [_jpeg(picture) for picture in color.images]
    for block in blocks(len(pictures)):
        yield Columns(COLOR, color.rows[block], rr.EncodedImage.columns(blob=pictures[block]))


def _jpeg(picture: NDArray[np.uint8]) -> bytes:
    """Return a (height, width, 3) picture in a tenth of its bytes."""
    file = BytesIO()
    Image.fromarray(picture).save(file, "JPEG", quality=JPEG_QUALITY, subsampling="4:4:4")
    return file.getvalue()
