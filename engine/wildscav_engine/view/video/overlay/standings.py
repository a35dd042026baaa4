"""The standings beside a picture: who leads, with what, and how everybody is."""

from collections.abc import Sequence

import numpy as np
from PIL import Image

from wildscav_engine.simulation.track import Track
from wildscav_engine.specs.actions import Field
from wildscav_engine.view.recording.history import History
from wildscav_engine.view.recording.ranking import Column, first_of, order_at, ranking_keys
from wildscav_engine.view.video.overlay.drawing import SOFT, WHITE, Color, health_bar, panel, put, text

MAX_LINES = 10
NAME, NUMBER = 8.2, 3.4  # times the height of the text, the widths of the columns
LINE = 1.5  # times the height of the text, the height of a line
DEAD = (140, 146, 154)


class Standings:
    """The standings of a match, which are drawn anew only when something in them changes."""

    def __init__(
        self, track: Track, history: History, names: Sequence[str], colors: Sequence[Color], size: int
    ) -> None:
        """Create the standings with text of a height in pixels."""
        agents = history.agents
        self._names, self._colors, self._size = names, colors, size
        self._keys = ranking_keys(track, history)
        self._has_health = Field.SHOOT in track.fields
        self._health = agents.health / np.maximum(1, agents.full_health)
        self._columns = []
        if history.target is not None:
            self._columns.append(Column("to go", history.distance_to_target, lambda far: f"{far:.0f} m"))
        if track.has_supplies:
            self._columns.append(Column("supplies", agents.supplies))
        if self._has_health:
            self._columns.append(Column("kills", agents.kills))
        self._drawn: dict[object, Image.Image] = {}

    @property
    def width(self) -> int:
        """The width of the panel in pixels."""
        return round(self._size * (1.6 + NAME + NUMBER * len(self._columns)))

    def draw(self, row: int, followed: int | None) -> Image.Image:
        """Return the standings after a step, with the best seats, and always with the followed one."""
        order = order_at(self._keys, row)
        shown = first_of(order, MAX_LINES, followed)
        lines = tuple(
            (seat, tuple(column.write(float(column.values[row, seat])) for column in self._columns))
            for seat in shown
        )
        health = tuple(round(20 * float(self._health[row, seat])) for seat in shown)
        key = (lines, health, followed)
        if key not in self._drawn:
            if len(self._drawn) > 64:
                self._drawn.clear()
            self._drawn[key] = self._draw(lines, health, followed, len(order) - len(shown))
        return self._drawn[key]

    def _draw(
        self,
        lines: tuple[tuple[int, tuple[str, ...]], ...],
        health: tuple[int, ...],
        followed: int | None,
        more: int,
    ) -> Image.Image:
        size, high = self._size, round(self._size * LINE)
        rows = len(lines) + 1 + (more > 0)
        picture = panel(self.width, rows * high + size // 2).copy()
        edges = [size * (1.2 + NAME + NUMBER * (index + 1)) for index in range(len(self._columns))]
        for column, edge in zip(self._columns, edges, strict=True):
            put(picture, text(column.title, round(0.78 * size), SOFT), edge, size * 0.4, anchor="rt")
        for line, ((seat, numbers), left) in enumerate(zip(lines, health, strict=True), start=1):
            y = line * high
            color = DEAD if left == 0 else WHITE if seat == followed else self._colors[seat]
            put(picture, text(self._names[seat], size, color, round(NAME * size)), size * 0.9, y)
            stripe = (size // 3, y + size // 4, round(size * 0.65), y + round(size * 1.2))
            picture.paste((*self._colors[seat], 255), stripe)
            if self._has_health and left:
                bar = health_bar(round(NAME * size), max(3, size // 5), left / 20)
                put(picture, bar, size * 0.9, y + 1.25 * size)
            for number, edge in zip(numbers, edges, strict=True):
                put(picture, text(number, size, color), edge, y, anchor="rt")
        if more > 0:
            put(picture, text(f"and {more} more", round(0.85 * size), SOFT), size * 0.9, (rows - 1) * high)
        return picture
