"""What agents say and draw beside their play, as replays and videos take it."""

from collections.abc import Sequence
from typing import Protocol


class Note(Protocol):
    """A note of an agent. It has a text, or a name with points, or a name with a value."""

    @property
    def seat(self) -> int:
        """Whose note it is."""

    @property
    def step(self) -> int:
        """The step before which it was made."""

    @property
    def text(self) -> str:
        """What is said."""

    @property
    def name(self) -> str:
        """The name of a mark or of a quantity."""

    @property
    def points(self) -> Sequence[tuple[float, float, float]]:
        """The points of a mark, m: none removes it, one is a place, several are a line."""

    @property
    def value(self) -> float | None:
        """The value of a quantity."""
