"""The scale on which a board draws its intervals, as parts of a picture 100 wide."""

from dataclasses import dataclass

from wildscav_leaderboard.boards.documents import BoardDocument, Row, place_of

MARGIN = 0.04  # of the width, on each side


@dataclass(frozen=True)
class Bar:
    """An interval and its middle, from 0 to 100."""

    low: float
    middle: float
    high: float


@dataclass(frozen=True)
class Scale:
    """The values at both ends of a board's pictures."""

    board: BoardDocument
    lowest: float
    highest: float

    @classmethod
    def of(cls, board: BoardDocument) -> "Scale":
        """Return the scale that shows all intervals of a board, or all that are settled if there are any."""
        ranked = [row for row in board.rows if row.rank is not None]
        settled = [row for row in ranked if not getattr(row, "provisional", False)]
        ends = [end for row in settled or ranked for end in place_of(board, row)[1:]]
        lowest, highest = min(ends, default=0.0), max(ends, default=1.0)
        room = (highest - lowest or 1.0) * MARGIN
        return cls(board, lowest - room, highest + room)

    def bar(self, row: Row) -> Bar:
        """Return a row's interval on this scale."""
        middle, low, high = (self._at(value) for value in place_of(self.board, row))
        return Bar(low, middle, high)

    def _at(self, value: float) -> float:
        share = (value - self.lowest) / (self.highest - self.lowest)
        return round(100.0 * min(max(share, 0.0), 1.0), 2)
