"""What boards draw as SVG: ranks over time, and intervals. Colours are classes, to fit light and dark."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta

from wildscav_leaderboard.boards.documents import BoardDocument, LadderRow, Row, place_of
from wildscav_leaderboard.boards.models import BoardPoint

WIDTH, ROW = 760.0, 26.0  # pixels; the second for each rank
LEFT, TOP, LABELS, BOTTOM = 34.0, 14.0, 150.0, 26.0  # margins
MAX_ROWS, MAX_POINTS = 12, 250  # ranks that get a row of their own, and points of a line
NEAREST = 17.0  # pixels between two labels
TICKS = 4
LONG = timedelta(days=2)  # from here on, days are marked instead of hours
MARGIN = 0.04  # of the width of an interval's picture, on each side
SHORT = timedelta(minutes=TICKS)  # up to here, seconds are marked, too


@dataclass
class Line:
    """The ranks of one team or submission."""

    label: str
    number: int  # which colour
    path: str  # through the middle of the ranks that it may have had
    band: str  # from the best to the worst of them; empty if it is not shown
    end: tuple[float, float]
    label_y: float = 0.0


@dataclass(frozen=True)
class Chart:
    """A picture of ranks over time."""

    lines: list[Line]
    ranks: list[tuple[float, int]]  # y and rank of each mark
    times: list[tuple[float, str]]  # x and text
    height: float
    width: float = WIDTH
    left: float = LEFT
    right: float = WIDTH - LABELS
    labels: float = WIDTH - LABELS + 10.0


@dataclass(frozen=True)
class _Frame:
    """Where times and ranks are in the picture."""

    begin: datetime
    end: datetime
    last_rank: int

    @property
    def step(self) -> float:
        """The height of a rank."""
        return ROW * min(1.0, MAX_ROWS / self.last_rank)

    def x(self, at: datetime) -> float:
        share = (at - self.begin) / (self.end - self.begin or timedelta(seconds=1))
        return round(LEFT + share * (WIDTH - LEFT - LABELS), 1)

    def y(self, rank: float) -> float:
        return round(TOP + (rank - 0.5) * self.step, 1)

    @property
    def height(self) -> float:
        return round(TOP + self.last_rank * self.step + BOTTOM, 1)


def rank_chart(
    histories: Sequence[tuple[str, Sequence[BoardPoint]]], until: datetime, *, bands: bool = False
) -> Chart | None:
    """Return a chart of the ranks of teams or submissions; None if there is nothing to draw a line through.

    Args:
        histories: The label and the history of each.
        until: The end of all lines.
        bands: Whether to show the ranks that could not be told apart.
    """
    drawn = [(label, _thinned(points)) for label, points in histories if points]
    every = [point for _, points in drawn for point in points]
    if len(every) < 2 or min(point.at for point in every) >= until:
        return None
    last_rank = max(point.last_rank for point in every)
    frame = _Frame(min(point.at for point in every), until, max(last_rank, len(drawn), 2))
    lines = [_line(label, number, points, frame, bands=bands) for number, (label, points) in enumerate(drawn)]
    _spread_labels(lines)
    height = max(frame.height, max(line.label_y for line in lines) + BOTTOM)
    return Chart(lines, _rank_marks(frame), _time_marks(frame), height)


def _thinned(points: Sequence[BoardPoint]) -> list[BoardPoint]:
    """Return some of many points, evenly chosen, with the last one."""
    every = -(-len(points) // MAX_POINTS)
    return [*points[:-1:every], points[-1]]


def _line(label: str, number: int, points: Sequence[BoardPoint], frame: _Frame, *, bands: bool) -> Line:
    # Where teams share a rank, their lines lie side by side.
    aside = 0.0 if bands else 0.07 * (number % 8) - 0.25
    ranks = [(point.rank + point.last_rank) / 2 + aside for point in points]
    path = _steps([frame.x(point.at) for point in points], [frame.y(rank) for rank in ranks], frame)
    end = (frame.x(frame.end), frame.y(ranks[-1]))
    return Line(label, number % 8, f"M{path}", _band(points, frame) if bands else "", end)


def _steps(xs: Sequence[float], ys: Sequence[float], frame: _Frame) -> str:
    """Return the corners of a line that keeps each value until the next one."""
    ends = [*xs[1:], frame.x(frame.end)]
    return " ".join(f"{x},{y} {end},{y}" for x, y, end in zip(xs, ys, ends, strict=True))


def _band(points: Sequence[BoardPoint], frame: _Frame) -> str:
    xs = [frame.x(point.at) for point in points]
    upper = _steps(xs, [frame.y(point.rank - 0.3) for point in points], frame)
    lower = _steps(xs, [frame.y(point.last_rank + 0.3) for point in points], frame)
    return f"M{upper} {' '.join(reversed(lower.split()))}Z"


def _spread_labels(lines: Iterable[Line]) -> None:
    """Put each label beside the end of its line, and below the one before it."""
    lowest = -NEAREST
    for line in sorted(lines, key=lambda one: one.end[1]):
        line.label_y = lowest = round(max(line.end[1], lowest + NEAREST), 1)


def _rank_marks(frame: _Frame) -> list[tuple[float, int]]:
    every = -(-frame.last_rank // MAX_ROWS)
    return [(frame.y(rank), rank) for rank in range(1, frame.last_rank + 1) if (rank - 1) % every == 0]


def _time_marks(frame: _Frame) -> list[tuple[float, str]]:
    whole = frame.end - frame.begin
    form = "%-d %b" if whole >= LONG else "%H:%M" if whole > SHORT else "%H:%M:%S"
    times = [frame.begin + whole * (number / TICKS) for number in range(TICKS + 1)]
    return [(frame.x(at), at.strftime(form)) for at in times]


@dataclass(frozen=True)
class Bar:
    """An interval and its middle, from 0 to 100."""

    low: float
    middle: float
    high: float


@dataclass(frozen=True)
class Scale:
    """The values at both ends of the pictures of a board's intervals, which are 100 wide."""

    board: BoardDocument
    lowest: float
    highest: float

    @classmethod
    def of(cls, board: BoardDocument) -> "Scale":
        """Return the scale that shows all intervals of a board, or all that are settled if there are any."""
        ranked = [row for row in board.rows if row.rank is not None and _is_measured(row)]
        settled = [row for row in ranked if not getattr(row, "provisional", False)]
        ends = [end for row in settled or ranked for end in place_of(board, row)[1:]]
        lowest, highest = min(ends, default=0.0), max(ends, default=1.0)
        room = (highest - lowest or 1.0) * MARGIN
        return cls(board, lowest - room, highest + room)

    def bar(self, row: Row) -> Bar | None:
        """Return a row's interval on this scale; None if too few matches were played for one."""
        if not _is_measured(row):
            return None
        middle, low, high = (self._at(value) for value in place_of(self.board, row))
        return Bar(low, middle, high)

    def _at(self, value: float) -> float:
        share = (value - self.lowest) / (self.highest - self.lowest)
        return round(100.0 * min(max(share, 0.0), 1.0), 2)


def _is_measured(row: Row) -> bool:
    return not isinstance(row, LadderRow) or row.is_measured
