"""The map in a corner of a video: everybody from above, with the target, the boxes and the safe zone."""

from functools import cached_property

import numpy as np
from PIL import Image, ImageDraw

from wildscav_engine.geometry.world import CELL
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.picture.raster import raster
from wildscav_engine.maps.picture.top_view import Window
from wildscav_engine.rendering.palette import of_seat
from wildscav_engine.view.recording.colors import NEXT_ZONE, OUTDOOR_BOX, TARGET, ZONE
from wildscav_engine.view.recording.history import History
from wildscav_engine.view.video.moments import Moment, boxes_at
from wildscav_engine.view.video.overlay.drawing import DARK, WHITE, arrowhead, dot, put

FRAME = 2  # pixels around the map
TURNS = 10  # degrees, to which arrowheads are rounded
DIM = 0.82  # share of the map's brightness, so that marks stand out
NEAREST_EDGE = 5  # pixels


class Inset:
    """The map of a match, ``size`` pixels wide and high."""

    def __init__(self, game_map: GameMap, history: History, size: int) -> None:
        """Create the inset; its ground is drawn with its first picture."""
        self._map, self._history, self.size = game_map, history, size
        columns = game_map.world.water.shape[1]
        self._west, self._north = float(game_map.world.corner[0]), -float(game_map.world.corner[1])
        self._step = columns * CELL / size  # m per pixel
        self._mark = max(5, round(size / 26))

    @cached_property
    def _ground(self) -> Image.Image:
        window = Window(self._west, self._north, self._step, self.size, self.size)
        return Image.fromarray((raster(self._map, window, None) * DIM).astype(np.uint8))

    def draw(self, moment: Moment, followed: int | None) -> Image.Image:
        """Return the map at a moment."""
        picture = self._ground.copy()
        self._draw_zone(picture, moment)
        for x, _, z in boxes_at(self._history, moment.row).position.tolist():
            put(picture, dot(max(4, self._mark // 2), OUTDOOR_BOX), *self._at(x, z), anchor="mm")
        if self._history.target is not None:
            x, _, z = self._history.target.tolist()
            put(picture, dot(self._mark + 3, TARGET), *self._at(x, z), anchor="mm")
        seats = np.nonzero(moment.alive)[0].tolist()
        for seat in sorted(seats, key=lambda each: each == followed):  # the followed one on top
            self._mark_agent(picture, moment, seat, is_followed=seat == followed)
        return _framed(picture)

    def _mark_agent(self, picture: Image.Image, moment: Moment, seat: int, *, is_followed: bool) -> None:
        x, _, z = moment.position[seat].tolist()
        turn = round(float(moment.yaw[seat]) / TURNS) * TURNS % 360
        if is_followed:
            put(picture, dot(2 * self._mark, WHITE), *self._at(x, z), anchor="mm")
        color = of_seat(self._history.team_of(seat))
        put(picture, arrowhead(self._mark, turn, color), *self._at(x, z), anchor="mm")

    def _draw_zone(self, picture: Image.Image, moment: Moment) -> None:
        if self._history.zone is None:
            return
        draw, zone = ImageDraw.Draw(picture), self._history.zone[moment.row].tolist()
        for (x, z, radius), color in ((zone[:3], ZONE), (zone[3:], NEXT_ZONE)):
            across, down = self._at(x, z)
            reach = radius / self._step
            draw.ellipse((across - reach, down - reach, across + reach, down + reach), outline=color, width=2)

    def _at(self, x: float, z: float) -> tuple[float, float]:
        """Return pixels to the right and down of a place, within the map."""
        across, down = (x - self._west) / self._step, (self._north - z) / self._step
        least, most = NEAREST_EDGE, self.size - NEAREST_EDGE
        return min(most, max(least, across)), min(most, max(least, down))


def _framed(picture: Image.Image) -> Image.Image:
    framed = Image.new("RGBA", (picture.width + 2 * FRAME, picture.height + 2 * FRAME), (*DARK, 220))
    framed.paste(picture, (FRAME, FRAME))
    return framed
