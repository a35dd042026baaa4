"""The overlay of a picture: clock, standings, feed, map, names, and how the followed agent is."""

from collections.abc import Sequence
from functools import cached_property, lru_cache

import numpy as np
from PIL import Image, ImageDraw

from wildscav_engine.geometry.rays import sight_is_clear
from wildscav_engine.geometry.world import CELL
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.picture.paint import raster
from wildscav_engine.maps.picture.top_view import Window
from wildscav_engine.record import Record
from wildscav_engine.rendering.palette import of_seat
from wildscav_engine.simulation.state import NOBODY, NOT_ELIMINATED
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.body import BODY_HEIGHT
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.tracks import TRACKS
from wildscav_engine.view.outcome import describe_outcome, format_time
from wildscav_engine.view.recording.agent_notes import Note
from wildscav_engine.view.recording.colors import NEXT_ZONE, OUTDOOR_BOX, TARGET, ZONE
from wildscav_engine.view.recording.history import History
from wildscav_engine.view.video.cameras import Camera
from wildscav_engine.view.video.moments import InterpolatedState, boxes_at
from wildscav_engine.view.video.overlay.captions import Captions
from wildscav_engine.view.video.overlay.drawing import (
    DARK,
    DYING,
    HEALTHY,
    SOFT,
    WHITE,
    Color,
    arrowhead,
    dot,
    health_bar,
    panel,
    put,
    text,
)
from wildscav_engine.view.video.overlay.feed import Feed
from wildscav_engine.view.video.overlay.standings import Standings

DESIGNED_FOR = 720  # pixels high: there text is 20 pixels high
SMALLEST_TEXT = 11  # pixels
TAG_REACH = 70.0  # m, up to which the names of agents are shown from the ground
TAG_HEIGHT = BODY_HEIGHT + 0.35  # m above the soles
FLASH = 12  # frames for which a hit shows
FRAME = 2  # pixels around the map
TURNS = 10  # degrees, to which arrowheads are rounded
DIM = 0.82  # share of the map's brightness, so that marks stand out
NEAREST_EDGE = 5  # pixels


class Hud:
    """Everything that is written over the pictures of one match."""

    def __init__(
        self, record: Record, game_map: GameMap, history: History, height: int, notes: Sequence[Note]
    ) -> None:
        """Create the overlay for pictures of a height in pixels."""
        self._record, self._map, self._history = record, game_map, history
        self.track = TRACKS[record.spec.track]
        self.text = max(SMALLEST_TEXT, round(20 * height / DESIGNED_FOR))
        self.names = [" ".join(name.split()) or f"seat {seat}" for seat, name in enumerate(record.names)]
        self.colors = [_bright(of_seat(history.team_of(seat))) for seat in range(len(self.names))]
        self.feed = Feed(history, self.names, self.colors)
        self.captions = Captions(notes, record.spec.frames_per_action, self.names, self.colors)
        small = round(0.8 * self.text)
        self.standings = Standings(self.track, history, self.names, self.colors, small)
        self.inset = Inset(game_map, history, round(max(96, 0.27 * height)))
        self._has_health = Field.SHOOT in self.track.fields

    def draw(
        self, picture: Image.Image, camera: Camera, moment: InterpolatedState, followed: int | None
    ) -> None:
        """Write everything over a picture of a camera."""
        gap = self.text // 2
        self.draw_tags(picture, camera, moment, followed)
        put(picture, self.clock(moment), picture.width / 2, gap, anchor="mt")
        put(picture, self.standings.draw(moment.row, followed), gap, gap)
        self.feed.draw(picture, moment.frame, picture.width - gap, gap, round(0.8 * self.text))
        inset = self.inset.draw(moment, followed)
        put(picture, inset, picture.width - gap, picture.height - gap, anchor="rb")
        if followed is not None:
            self.draw_state(picture, moment, followed)
        self.captions.draw(picture, moment.frame, followed, self.text)
        self.draw_end(picture, moment)

    def clock(self, moment: InterpolatedState) -> Image.Image:
        """Return the time of the match, and what is played."""
        limit = round(self._record.spec.time_limit * FRAMES_PER_SECOND)
        return _clock(f"{format_time(int(moment.frame))} / {format_time(limit)}", self.track.title, self.text)

    def draw_tags(
        self, picture: Image.Image, camera: Camera, moment: InterpolatedState, followed: int | None
    ) -> None:
        """Write the names of the agents in view over their heads, with their health.

        From above, with nobody followed, all are named; from the ground those that are near and in sight.
        """
        heads = moment.position + np.array([0.0, TAG_HEIGHT, 0.0])
        seen = camera.onto(heads, picture.width, picture.height)
        far = np.linalg.norm(heads - camera.eye, axis=1)
        for seat in np.argsort(-far).tolist():
            x, y, depth = seen[seat].tolist()
            is_in_view = depth > 0.5 and 0 <= x < picture.width and 0 <= y < picture.height
            if not moment.alive[seat] or seat in {camera.hidden, followed} or not is_in_view:
                continue
            points = *camera.eye.tolist(), *heads[seat].tolist()
            if followed is None or (far[seat] <= TAG_REACH and sight_is_clear(self._map.world, *points)):
                self._draw_tag(picture, moment, seat, x, y, is_marked=followed is None)

    def _draw_tag(
        self,
        picture: Image.Image,
        moment: InterpolatedState,
        seat: int,
        x: float,
        y: float,
        *,
        is_marked: bool,
    ) -> None:
        size = round(0.75 * self.text)
        if is_marked:
            put(picture, arrowhead(size // 2 + 2, 180, self.colors[seat]), x, y, anchor="mm")
            y -= 0.8 * size
        if self._has_health:
            bar = health_bar(3 * size, max(4, size // 3), self._health(moment, seat))
            put(picture, bar, x, y, anchor="mb")
            y -= size // 3
        put(picture, text(self.names[seat], size, self.colors[seat], 10 * size), x, y, anchor="mb")

    def _health(self, moment: InterpolatedState, seat: int) -> float:
        agents = self._history.agents
        return float(agents.health[moment.row, seat] / max(1, agents.full_health[moment.row, seat]))

    def draw_state(self, picture: Image.Image, moment: InterpolatedState, seat: int) -> None:
        """Write how the followed agent is: its name, health, ammunition and supplies."""
        size, gap, agents, row = self.text, self.text // 2, self._history.agents, moment.row
        facts = self._facts(moment, seat)
        wide, line = 15 * size, round(1.35 * size)
        high = round(1.8 * size) + (size if self._has_health else 0) + (line if facts else 0)
        left, top = gap, picture.height - gap - high
        put(picture, panel(wide, high), left, top)
        name = text(self.names[seat], round(1.1 * size), self.colors[seat], wide - size)
        put(picture, name, left + gap, top + 3)
        y = top + round(1.7 * size)
        if self._has_health:
            bar = health_bar(wide - size, round(0.7 * size), self._health(moment, seat))
            put(picture, bar, left + gap, y)
            number = text(f"{max(0, int(agents.health[row, seat]))}", round(0.75 * size))
            put(picture, number, left + wide - 0.7 * size, y + 0.35 * size, anchor="rm")
            y += size
        x = float(left + gap)
        for title, value in facts:
            for words, color in ((value, WHITE), (title, SOFT)):
                patch = text(words, size if color == WHITE else round(0.75 * size), color)
                put(picture, patch, x, y + (0 if color == WHITE else 0.25 * size))
                x += patch.width + size * (0.15 if color == WHITE else 0.6)
        if not moment.alive[seat]:
            self._draw_notice(picture, self._death(moment, seat), DYING)

    def _facts(self, moment: InterpolatedState, seat: int) -> list[tuple[str, str]]:
        agents, row = self._history.agents, moment.row
        facts = []
        if self._has_health:
            ammunition = f"{agents.clip[row, seat]} + {agents.spare_ammo[row, seat]}"
            is_reloading = agents.reload_left[row, seat] > 0
            facts.append(("reloading" if is_reloading else "rounds", ammunition))
        if self.track.has_supplies:
            facts.append(("supplies", f"{agents.supplies[row, seat]}"))
        if self._history.target is not None:
            facts.append(("to the target", f"{self._history.distance_to_target[row, seat]:.0f} m"))
        return facts

    def _death(self, moment: InterpolatedState, seat: int) -> str:
        agents, row = self._history.agents, moment.row
        if agents.eliminated[row, seat] != NOT_ELIMINATED:
            return f"{self.names[seat]} is out"
        left = int(agents.respawn_left[row, seat])
        return f"{self.names[seat]} is dead, back in {-(-left // FRAMES_PER_SECOND)} s"

    def draw_aim(self, picture: Image.Image, moment: InterpolatedState, seat: int) -> None:
        """Draw the crosshair, a cross where a shot hit, and a red edge after a hit by others."""
        if not self._has_health:
            return
        agents, row = self._history.agents, moment.row
        is_recent = moment.frame - self._history.frame[row] < FLASH
        draw = ImageDraw.Draw(picture)
        x, y, arm = picture.width / 2, picture.height / 2, max(4, picture.height // 80)
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            ends = (x + dx * arm * 0.5, y + dy * arm * 0.5, x + dx * arm * 1.6, y + dy * arm * 1.6)
            draw.line(ends, (0, 0, 0), 4)
            draw.line(ends, WHITE, 2)
        if is_recent and agents.fired[row, seat] and agents.hit_seat[row, seat] != NOBODY:
            for dx, dy in ((1, 1), (-1, 1), (1, -1), (-1, -1)):
                ends = (x + dx * arm * 0.8, y + dy * arm * 0.8, x + dx * arm * 1.8, y + dy * arm * 1.8)
                draw.line(ends, DYING, 3)
        if row and agents.health[row, seat] < agents.health[row - 1, seat]:
            _redden(picture)

    def draw_end(self, picture: Image.Image, moment: InterpolatedState) -> None:
        """Write who won, once the match is over."""
        if moment.row == len(self._history.frame) - 1:
            self._draw_notice(picture, describe_outcome(self._record.result, self.names), HEALTHY)

    def _draw_notice(self, picture: Image.Image, words: str, color: Color) -> None:
        patch = text(words, round(1.2 * self.text), WHITE, round(0.8 * picture.width))
        wide, high = patch.width + 2 * self.text, patch.height + self.text
        x, y = picture.width / 2, picture.height * 0.27
        put(picture, panel(wide, high), x, y, anchor="mm")
        stripe = Image.new("RGBA", (wide, max(2, self.text // 6)), (*color, 255))
        put(picture, stripe, x, y + high / 2, anchor="mt")
        put(picture, patch, x, y, anchor="mm")

    def draw_label(self, picture: Image.Image, moment: InterpolatedState, seat: int) -> None:
        """Write a seat's name and health at the top of a small picture."""
        size, gap = round(0.8 * self.text), self.text // 4
        name = text(self.names[seat], size, self.colors[seat], picture.width - 2 * size)
        high = name.height + (size // 2 if self._has_health else 0)
        put(picture, panel(picture.width, high + gap, 0), 0, 0)
        put(picture, name, gap, 0)
        facts = "  ".join(value for title, value in self._facts(moment, seat)[int(self._has_health) :])
        put(picture, text(facts, size), picture.width - gap, 0, anchor="rt")
        if self._has_health:
            bar = health_bar(picture.width - 2 * gap, max(4, size // 3), self._health(moment, seat))
            put(picture, bar, gap, name.height)
        if not moment.alive[seat]:
            left = int(self._history.agents.respawn_left[moment.row, seat])
            notice = f"back in {-(-left // FRAMES_PER_SECOND)} s" if left else "out"
            put(picture, text(notice, self.text, DYING), picture.width / 2, picture.height / 2, anchor="mm")


@lru_cache(maxsize=8)
def _clock(time: str, title: str, size: int) -> Image.Image:
    above, below = text(title, round(0.7 * size), SOFT), text(time, round(1.15 * size))
    wide, high = max(above.width, below.width) + size, above.height + below.height + size // 3
    picture = panel(wide, high).copy()
    put(picture, above, wide / 2, size // 8, anchor="mt")
    put(picture, below, wide / 2, above.height, anchor="mt")
    return picture


def _bright(color: Sequence[int]) -> Color:
    """Return a colour that can be read on a dark ground."""
    red, green, blue = (round(channel + (255 - channel) * 0.25) for channel in color)
    return red, green, blue


def _redden(picture: Image.Image) -> None:
    """Lay a red edge over a picture."""
    across, down = np.meshgrid(np.linspace(-1, 1, 32), np.linspace(-1, 1, 18))
    edge = np.clip((np.maximum(np.abs(across), np.abs(down)) - 0.6) / 0.4, 0, 1)
    small = Image.fromarray((170 * edge).astype(np.uint8))
    mask = small.resize(picture.size, Image.Resampling.BILINEAR)
    picture.paste((200, 30, 24), (0, 0), mask)


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

    def draw(self, moment: InterpolatedState, followed: int | None) -> Image.Image:
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
            x, _, z = moment.position[seat].tolist()
            turn = round(float(moment.yaw[seat]) / TURNS) * TURNS % 360
            if seat == followed:
                put(picture, dot(2 * self._mark, WHITE), *self._at(x, z), anchor="mm")
            color = of_seat(self._history.team_of(seat))
            put(picture, arrowhead(self._mark, turn, color), *self._at(x, z), anchor="mm")
        framed = Image.new("RGBA", (picture.width + 2 * FRAME, picture.height + 2 * FRAME), (*DARK, 220))
        framed.paste(picture, (FRAME, FRAME))
        return framed

    def _draw_zone(self, picture: Image.Image, moment: InterpolatedState) -> None:
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
