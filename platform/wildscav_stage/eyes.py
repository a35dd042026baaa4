"""What a seat sees, as compressed pictures."""

import io
from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from wildscav_engine.sensors import parse_sensors
from wildscav_engine.simulation.state import State, copied

if TYPE_CHECKING:
    from wildscav_engine.maps.game_map import GameMap
    from wildscav_engine.simulation.match_view import MatchView
    from wildscav_engine.simulation.systems.visibility import Seen
    from wildscav_engine.specs.match_spec import MatchSpec

WIDTH, HEIGHT = 640, 360  # pixels
FIELD_OF_VIEW = 85.0  # degrees
QUALITY = 78  # of JPEG


class Moment(NamedTuple):
    """A match at one moment; unlike the match itself, it stays as it is while a picture is made of it."""

    spec: "MatchSpec"
    game_map: "GameMap"
    seats: int
    state: State
    seen: "Seen"
    frame: int


def moment_of(match: "MatchView") -> Moment:
    """Return a copy of the present state of a match."""
    state = State(*map(copied, match.state))
    return Moment(match.spec, match.game_map, match.seats, state, match.seen, match.frame)


class Eyes:
    """Makes the pictures of one seat, with the camera that submissions have, too.

    Args:
        seat: The seat whose camera it is.
        width: Pixels.
        height: Pixels.
    """

    def __init__(self, seat: int, width: int = WIDTH, height: int = HEIGHT) -> None:
        options = {"width": width, "height": height, "field_of_view": FIELD_OF_VIEW}
        self.camera, self._seat = parse_sensors({"camera": options})["camera"], seat

    def prepare(self, game_map: "GameMap") -> None:
        """Compute in advance what pictures of a map are made from."""
        self.camera.prepare(game_map)

    def picture(self, moment: Moment) -> bytes:
        """Return what the seat sees at a moment, as JPEG."""
        return as_jpeg(self.camera.read(cast("MatchView", moment), [self._seat])[0])


def as_jpeg(pixels: NDArray[np.uint8]) -> bytes:
    """Return (H, W, 3) pixels as JPEG."""
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "JPEG", quality=QUALITY)
    return file.getvalue()
