"""What agents say, at the bottom of a picture."""

from bisect import bisect_right
from collections.abc import Sequence

from PIL import Image

from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.view.recording.agent_notes import Note
from wildscav_engine.view.video.overlay.drawing import Color, font, panel, put, text

SHORTEST, LETTER, LONGEST = 3.0, 0.05, 12.0  # s that a caption is shown at least, for each letter, at most
MAX_LINES = 3
WIDTH = 0.6  # share of the picture's


class Captions:
    """The captions of a match: what agents said, in the order of their steps of some frames."""

    def __init__(
        self, notes: Sequence[Note], frames_per_action: int, names: Sequence[str], colors: Sequence[Color]
    ) -> None:
        self._said = [note for note in notes if note.text]
        self._frames = [note.step * frames_per_action for note in self._said]
        self._names, self._colors = names, colors

    def at(self, frame: float, seat: int | None) -> Note | None:
        """Return what is said in a frame: by a seat, or by whoever spoke last; None if nothing is."""
        for place in reversed(range(bisect_right(self._frames, frame))):
            note, age = self._said[place], (frame - self._frames[place]) / FRAMES_PER_SECOND
            if age > LONGEST:
                break
            if seat in {None, note.seat}:
                return note if age < SHORTEST + LETTER * len(note.text) else None
        return None

    def draw(self, picture: Image.Image, frame: float, seat: int | None, size: int) -> None:
        """Write what is said in a frame, in text of a height in pixels."""
        note = self.at(frame, seat)
        if note is None:
            return
        widest = round(WIDTH * picture.width)
        lines = _wrapped(f"{self._names[note.seat]}: {note.text}", size, widest)
        patches = [text(line, size, self._colors[note.seat], widest) for line in lines]
        high = patches[0].height
        top = picture.height - (len(patches) + 3) * high
        wide = max(patch.width for patch in patches) + size
        put(picture, panel(wide, high * len(patches) + size // 2), picture.width / 2, top, anchor="mt")
        for line, patch in enumerate(patches):
            put(picture, patch, picture.width / 2, top + line * high + size // 4, anchor="mt")


def _wrapped(words: str, size: int, widest: int) -> list[str]:
    """Return a text in lines that fit into some pixels; the last one holds what is left."""
    lines = [""]
    for word in words.split():
        longer = f"{lines[-1]} {word}".strip()
        if len(lines) < MAX_LINES and lines[-1] and font(size).getlength(longer) > widest:
            lines.append(word)
        else:
            lines[-1] = longer
    return lines
