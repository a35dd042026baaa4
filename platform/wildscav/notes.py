"""What an agent says and draws beside its play: notes, which replays, videos and pages show.

A note is a line that the agent prints: ``@wildscav `` and a JSON object of one of three forms.

    @wildscav {"step": 12, "say": "I hide."}
    @wildscav {"step": 12, "mark": "goal", "at": [[3.0, 0.5, -7.25]]}
    @wildscav {"step": 12, "plot": "fear", "value": 0.3}

With ``"public": true``, other teams of a season may see it as well, once they may see the match's record.

So notes are part of the agent's log. They are bounded as it is, seen by whoever may see it, and never part of
a match's record or result. An agent in Python calls ``say``, ``mark`` and ``plot``; others print such lines.
"""

import json
import math
import sys
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from wildscav.agent import Vector
from wildscav.errors import AgentError

PREFIX = "@wildscav "
LONGEST_TEXT = 2_000  # characters of what is said
LONGEST_NAME = 40  # characters
MOST_POINTS = 100  # of a mark
MOST_A_STEP = 8  # notes
LONGEST_LINE = 20_000  # characters; longer ones are no notes
FARTHEST = 1e5  # m from the middle of the map


class Note(NamedTuple):
    """One note. It has a text, or a name with points, or a name with a value."""

    seat: int
    step: int  # before which it was made
    text: str = ""  # what is said
    name: str = ""  # of a mark or of a quantity; a mark replaces that of the same name
    points: tuple[Vector, ...] = ()  # m, of a mark: none removes it, one is a place, several are a line
    value: float | None = None  # of a quantity
    public: bool = False  # whether other teams may see it


class _Pad:
    """Where this process writes its notes: nowhere, until it plays a step of a match."""

    step: int | None = None
    left = 0  # notes that this step may still have


def begin_step(step: int | None) -> None:
    """Note for which step an agent is asked from now on; None: notes are dropped, as outside of matches."""
    _Pad.step, _Pad.left = step, MOST_A_STEP


def say(text: str, *, public: bool = False) -> None:
    """Say something, for people who watch the match.

    Args:
        text: At most 2,000 characters; the rest is cut off.
        public: Whether other teams of a season may read it.

    Raises:
        AgentError: It is no text.
    """
    if not isinstance(text, str):
        raise AgentError(f"say: the text is {text!r}, must be a string")
    _write(public, say=text[:LONGEST_TEXT])


def mark(name: str, *places: Vector, public: bool = False) -> None:
    """Mark a place, or draw a line through several, until the next mark of this name. None removes the mark.

    Args:
        name: Shown beside the mark, at most 40 characters.
        places: (x, y, z) in m, at most 100.
        public: Whether other teams of a season may see it.

    Raises:
        AgentError: The name is no text, there are too many places, or one is none.
    """
    try:
        points = [[round(float(number), 3) for number in place] for place in places]
    except (TypeError, ValueError, OverflowError):
        points = [[]]
    if not _are_places([*points]):
        raise AgentError(f"mark {name!r}: places are at most {MOST_POINTS}, each x, y, z in m")
    _write(public, mark=_name("mark", name), at=points)


def plot(name: str, value: float, *, public: bool = False) -> None:
    """Give the value of a quantity from now on, to plot it over time.

    Args:
        name: Of the quantity, at most 40 characters.
        value: Between -100,000 and 100,000.
        public: Whether other teams of a season may see it.

    Raises:
        AgentError: The name is no text, or the value no such number.
    """
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not _is_near(number):
        raise AgentError(f"plot {name!r}: the value is {value!r}, must be within ±{FARTHEST:,.0f}")
    _write(public, plot=_name("plot", name), value=number)


def _name(what: str, name: object) -> str:
    if not isinstance(name, str) or not 0 < len(name) <= LONGEST_NAME:
        raise AgentError(f"{what}: the name is {name!r}, must be a string of 1 to {LONGEST_NAME} characters")
    return name


def _write(public: bool, **content: Any) -> None:
    """Print a note of this step, unless it has too many already."""
    if _Pad.step is not None and _Pad.left > 0:
        _Pad.left -= 1
        sys.stdout.write(note_line(_Pad.step, **content, **({"public": True} if public else {})))
        sys.stdout.flush()


def note_line(step: int, **content: Any) -> str:
    """Return the line of a note, with its end; ``content`` has the keys of one of the three forms."""
    return f"{PREFIX}{json.dumps({'step': step, **content}, allow_nan=False)}\n"


def read_notes(lines: Iterable[str], seat: int) -> Iterator[Note]:
    """Yield the notes in the lines of a log, which may hold anything.

    Skipped are lines that are no notes, notes of earlier steps than the one before, and too many of one step.
    """
    step, count = 0, 0
    for line in lines:
        note = _read(line, seat) if line.startswith(PREFIX) and len(line) <= LONGEST_LINE else None
        if note is None or note.step < step:
            continue
        step, count = note.step, count + 1 if note.step == step else 1
        if count <= MOST_A_STEP:
            yield note


def _read(line: str, seat: int) -> Note | None:
    try:
        content = json.loads(line[len(PREFIX) :])
    except (ValueError, RecursionError):
        return None
    if not isinstance(content, dict) or type(step := content.get("step")) is not int or not 0 <= step < 2**31:
        return None
    public = content.get("public") is True
    match content:
        case {"say": str(text)} if text.strip():
            return Note(seat, step, text=_visible(text)[:LONGEST_TEXT], public=public)
        case {"mark": str(name), "at": list(points)} if _fits(name) and _are_places(points):
            places = tuple((x, y, z) for x, y, z in points)
            return Note(seat, step, name=_visible(name), points=places, public=public)
        case {"plot": str(name), "value": value} if _fits(name) and _is_near(value):
            return Note(seat, step, name=_visible(name), value=float(value), public=public)
    return None


def _visible(text: str) -> str:
    """Return a text in one line, without what is no character by itself, or controls a terminal."""
    return "".join(letter if letter.isprintable() else " " for letter in text)


def _are_places(points: list[object]) -> bool:
    return len(points) <= MOST_POINTS and all(map(_is_place, points))


def _fits(name: str) -> bool:
    return 0 < len(name) <= LONGEST_NAME


def _is_place(place: object) -> bool:
    return isinstance(place, list) and len(place) == 3 and all(map(_is_near, place))


def _is_near(number: object) -> bool:
    """Whether something is a finite number of a size that can be drawn."""
    return type(number) in {int, float} and -FARTHEST <= number <= FARTHEST  # type: ignore[operator]
