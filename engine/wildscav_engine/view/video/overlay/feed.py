"""What happened in the last seconds: who shot whom, who is out, who reached the target."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from PIL import Image

from wildscav_engine.simulation.state import NOBODY
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.view.recording.colors import TARGET
from wildscav_engine.view.recording.history import History
from wildscav_engine.view.video.overlay.drawing import WHITE, Color, panel, put, text

SHOWN_FOR = 6.0  # s
MAX_LINES = 5


class Part(NamedTuple):
    """A piece of a line: a seat's name in the colour of its team, or words."""

    words: str
    seat: int | None = None


class News(NamedTuple):
    """One line of the feed."""

    frame: int
    parts: tuple[Part, ...]


def news_of(history: History, names: Sequence[str]) -> list[News]:
    """Return everything that the feed of a match tells, in its order."""
    news = []
    for row, seat, by, is_out in history.deaths():
        parts: tuple[Part, ...] = (Part(names[seat], seat), Part("is out" if is_out else "died"))
        if by != NOBODY:
            parts = (Part(names[by], by), Part("shot"), Part(names[seat], seat))
        news.append(News(int(history.frame[row]), parts))
    arrival = history.arrival()
    if arrival is not None:
        row, seat = arrival
        parts = (Part(names[seat], seat), Part("reached the target"))
        news.append(News(int(history.frame[row]), parts))
    return news


class Feed:
    """The feed of a match."""

    def __init__(self, history: History, names: Sequence[str], colors: Sequence[Color]) -> None:
        """Collect the news of the whole match."""
        self._news, self._colors = news_of(history, names), colors
        self._frames = np.array([item.frame for item in self._news], np.int64)

    def at(self, frame: float) -> list[News]:
        """Return the latest news, the oldest first."""
        first = np.searchsorted(self._frames, frame - SHOWN_FOR * FRAMES_PER_SECOND, side="right")
        last = int(np.searchsorted(self._frames, frame, side="right"))
        return self._news[max(int(first), last - MAX_LINES) : last]

    def draw(self, picture: Image.Image, frame: float, right: float, top: float, size: int) -> None:
        """Write the latest news below each other; edges and the height of the text are in pixels."""
        for line, item in enumerate(self.at(frame)):
            widths = [0 if part.seat is None else 11 * size for part in item.parts]
            words = [
                text(part.words, size, self._color(part), width)
                for part, width in zip(item.parts, widths, strict=True)
            ]
            gap = size // 3
            wide = sum(word.width for word in words) + gap * (len(words) + 1)
            high = words[0].height
            y = top + line * (high + gap)
            put(picture, panel(wide, high), right, y, anchor="rt")
            x = right - wide + gap
            for word in words:
                put(picture, word, x, y)
                x += word.width + gap

    def _color(self, part: Part) -> Color:
        if part.seat is not None:
            return self._colors[part.seat]
        return TARGET if "target" in part.words else WHITE
