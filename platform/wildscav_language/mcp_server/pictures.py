"""Pictures of what a seat sees."""

from functools import lru_cache
from io import BytesIO
from typing import TYPE_CHECKING

from PIL import Image

from wildscav_engine.sensors import Sensor, allowed_sensors, parse_sensor
from wildscav_language.senses import PICTURE

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match

CAMERA = "camera"


@lru_cache(maxsize=1)
def _camera() -> Sensor:
    return parse_sensor(CAMERA, PICTURE)


def picture_of(match: "Match", seat: int) -> bytes:
    """Return what the camera of a seat sees now, as PNG; it shows what the match's senses allow."""
    camera = allowed_sensors({CAMERA: _camera()}, match.spec.rules)[CAMERA]
    camera.prepare(match.game_map)
    file = BytesIO()
    Image.fromarray(camera.read(match, [seat])[0]).save(file, "PNG")
    return file.getvalue()
