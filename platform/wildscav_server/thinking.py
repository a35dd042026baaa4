"""What agents spend on thinking: tokens that a model writes, and seconds of processors."""

from collections.abc import Callable
from typing import TypeAlias

# Returns what a seat has spent since its agent was started: tokens that its model has written, thoughts and
# answers, and s in which a thread of its own ran. It is called with every answer, so it must be quick.
Spending: TypeAlias = Callable[[], tuple[int, float]]


class Purse:
    """Counts what a seat has spent on thinking since its match began, in whole numbers."""

    def __init__(self) -> None:
        self._spending: Spending = lambda: (0, 0.0)
        self._seen = 0, 0  # tokens and ns of all that was spent so far and is taken, or left out
        self.tokens = 0
        self.processor = 0  # ns

    def count(self, spending: Spending) -> None:
        """Count from now on what something says that the seat spends."""
        self._spending = spending
        self.begin()

    def begin(self) -> None:
        """Leave out all that was spent before now and not taken."""
        self._seen = self._total()

    def take(self) -> tuple[int, int]:
        """Return the tokens and the ns of a processor that were spent since this was last called."""
        total, seen = self._total(), self._seen
        self._seen = max(total[0], seen[0]), max(total[1], seen[1])  # a count that falls gives nothing back
        new = self._seen[0] - seen[0], self._seen[1] - seen[1]
        self.tokens, self.processor = self.tokens + new[0], self.processor + new[1]
        return new

    def _total(self) -> tuple[int, int]:
        tokens, seconds = self._spending()
        return tokens, round(seconds * 1e9)
