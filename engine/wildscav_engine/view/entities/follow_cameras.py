"""The cameras that follow one agent, from above and at its eyes, and the images of its own cameras."""

from collections.abc import Iterator
from io import BytesIO

import numpy as np
import rerun as rr
from numpy.typing import NDArray
from PIL import Image

from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.view.entities.depth import moving_depth, static_depth
from wildscav_engine.view.recording import camera_poses, coordinates
from wildscav_engine.view.recording.columns import Columns, blocks
from wildscav_engine.view.recording.history import DEPTH_CAMERA, History, ImageSequence

ABOVE, EYES, COLOR = "follow/above", "follow/eyes", "follow/color"
ANGLES = {ABOVE: 70.0, EYES: 75.0}  # degrees horizontally
JPEG_QUALITY = 80
# The outline of a camera, so close to it that it is invisible in the view through the camera.
OUTLINE = 1e-4  # m


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
