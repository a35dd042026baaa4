"""The cameras that follow one agent, from above and from its eyes, and what its own camera shows it."""

from collections.abc import Iterator
from io import BytesIO

import numpy as np
import rerun as rr
from numpy.typing import NDArray
from PIL import Image

from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.view.entities.depth import moving_depth, static_depth
from wildscav_engine.view.recording import cameras, frame
from wildscav_engine.view.recording.columns import Columns, blocks
from wildscav_engine.view.recording.history import DEPTH_CAMERA, Film, History

ABOVE, EYES, COLOR = "follow/above", "follow/eyes", "follow/color"
ANGLES = {ABOVE: 70.0, EYES: 75.0}  # degrees wide
JPEG_QUALITY = 80
# So near to the eye that nothing of the camera's own outline is drawn in the view through it.
OUTLINE = 1e-4  # m


def static_cameras(history: History) -> Iterator[tuple[str, rr.AsComponents]]:
    """Yield what the cameras are like."""
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
    """Yield where the cameras are, and what the agent's own see."""
    yield _moving(ABOVE, history, cameras.above(game_map.world, history.agents, seat))
    yield _moving(EYES, history, cameras.at_the_eyes(history.agents, seat))
    if history.depth is not None:
        yield from moving_depth(history.depth)
    if history.color is not None:
        yield from _color(history.color)


def _moving(camera: str, history: History, poses: cameras.Poses) -> Columns:
    transforms = rr.Transform3D.columns(
        translation=frame.points(poses.position),
        quaternion=frame.camera_rotations(poses.yaw, poses.pitch),
    )
    return Columns(camera, history.rows, transforms)


def _color(color: Film) -> Iterator[Columns]:
    pictures = [_jpeg(picture) for picture in color.images]
    for block in blocks(len(pictures)):
        yield Columns(COLOR, color.rows[block], rr.EncodedImage.columns(blob=pictures[block]))


def _jpeg(picture: NDArray[np.uint8]) -> bytes:
    """Return a (height, width, 3) picture in a tenth of its bytes."""
    file = BytesIO()
    Image.fromarray(picture).save(file, "JPEG", quality=JPEG_QUALITY, subsampling="4:4:4")
    return file.getvalue()
