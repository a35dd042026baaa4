"""What a seat's camera shows, as a PNG file, with the numbers of boxes and agents if they are wanted."""

import io
import math
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from wildscav.agent import Observation, Vector
from wildscav.geometry import BODY_HEIGHT, EYE_HEIGHT
from wildscav_language.senses import FIELD_OF_VIEW

if TYPE_CHECKING:
    from PIL.ImageDraw import ImageDraw

BOX_HEIGHT = 0.5  # m, above which a box has its mark
TEXT_SIZE = 12  # pixels
INK, PAPER = (255, 255, 255), (20, 24, 28)


def picture(image: NDArray[Any], observation: Observation, *, marks: bool) -> bytes:
    """Return an image of a seat's camera as a PNG file.

    Args:
        image: (height, width, 3) what the camera read, with a field of view of ``FIELD_OF_VIEW``.
        observation: Of the same step.
        marks: Whether the boxes and agents that the seat is told of have their numbers.
    """
    from PIL import Image, ImageDraw

    drawn = Image.fromarray(image)
    if marks:
        draw = ImageDraw.Draw(drawn)
        for box in observation.supply_boxes[::-1]:
            _mark(draw, observation, box.position, BOX_HEIGHT, f"box {box.id}")
        for agent in observation.agents[::-1]:
            _mark(draw, observation, agent.position, BODY_HEIGHT, f"agent {agent.seat}")
    file = io.BytesIO()
    drawn.save(file, "PNG")
    return file.getvalue()


def _mark(draw: "ImageDraw", observation: Observation, place: Vector, top: float, text: str) -> None:
    """Write a text above a place; nothing if it is out of the picture."""
    from PIL import ImageFont

    width, height = draw.im.size
    at = pixel_of((place[0], place[1] + top, place[2]), observation, width, height)
    if at is None:
        return
    font = ImageFont.load_default(TEXT_SIZE)
    left, upper, right, lower = draw.textbbox(at, text, font=font, anchor="mb")
    draw.rectangle((left - 3, upper - 2, right + 3, lower + 2), fill=PAPER)
    draw.text(at, text, fill=INK, font=font, anchor="mb")


def pixel_of(point: Vector, observation: Observation, width: int, height: int) -> tuple[float, float] | None:
    """Return the column and row at which a camera shows a point (m), or None if it is out of the picture."""
    x, y, z = observation.position
    east, up, north = point[0] - x, point[1] - y - EYE_HEIGHT, point[2] - z
    yaw, pitch = math.radians(observation.yaw), math.radians(observation.pitch)
    right = east * math.cos(yaw) - north * math.sin(yaw)
    level = east * math.sin(yaw) + north * math.cos(yaw)
    ahead = level * math.cos(pitch) - up * math.sin(pitch)
    above = level * math.sin(pitch) + up * math.cos(pitch)
    if ahead <= 0.0:
        return None
    focus = width / 2.0 / math.tan(math.radians(FIELD_OF_VIEW / 2.0))
    column, row = width / 2.0 + focus * right / ahead, height / 2.0 - focus * above / ahead
    return (column, row) if 0.0 <= column < width and 0.0 <= row < height else None
