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
TEXT_SIZE, LINE = 12, 16  # pixels
ROWS = 6  # in which marks above one another may stand
INK, PAPER = (255, 255, 255), (20, 24, 28)


def picture(image: NDArray[Any], observation: Observation, *, marks: bool) -> bytes:
    """Return what a seat's camera shows, (height, width, 3), as a PNG file.

    With ``marks``, the boxes and agents in the observation of the same step have their numbers.
    """
    from PIL import Image, ImageDraw

    drawn = Image.fromarray(image)
    if marks:
        marked = _Marks(ImageDraw.Draw(drawn), observation)
        for agent in observation.agents:
            marked.add(agent.position, BODY_HEIGHT, f"agent {agent.seat}")
        for box in observation.supply_boxes:
            marked.add(box.position, BOX_HEIGHT, f"box {box.id}")
    file = io.BytesIO()
    drawn.save(file, "PNG")
    return file.getvalue()


class _Marks:
    """The marks of a picture, the nearest things' first; others give way to them, upwards."""

    def __init__(self, draw: "ImageDraw", observation: Observation) -> None:
        from PIL import ImageFont

        self.draw, self.observation = draw, observation
        self.font = ImageFont.load_default(TEXT_SIZE)
        self.taken: list[tuple[float, float, float, float]] = []  # left, upper, right and lower edges

    def add(self, place: Vector, top: float, text: str) -> None:
        """Write a text above a place; nothing if it is out of the picture, or there is no room."""
        at = pixel_of((place[0], place[1] + top, place[2]), self.observation, *self.draw.im.size)
        if at is None:
            return
        left, upper, right, lower = self.draw.textbbox(at, text, font=self.font, anchor="mb")
        for rise in range(0, ROWS * LINE, LINE):
            edges = (left - 3.0, upper - 2.0 - rise, right + 3.0, lower + 2.0 - rise)
            if not any(_overlap(edges, other) for other in self.taken):
                self.taken.append(edges)
                self.draw.rectangle(edges, fill=PAPER)
                self.draw.text((at[0], at[1] - rise), text, fill=INK, font=self.font, anchor="mb")
                return


def _overlap(a: tuple[float, float, float, float], b: tuple[float, float, float, float]) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


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
