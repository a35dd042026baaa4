"""What agents spend on thinking: tokens that a model writes, and seconds of processors."""

from typing import NamedTuple, Protocol


class Spent(NamedTuple):
    """What a seat has spent since its agent was started. Neither number ever falls."""

    tokens: int = 0  # that its model has written, thoughts and answers
    processor: float = 0.0  # s in which a thread of its own ran


class Spending(Protocol):
    """Counts what a seat spends. A match whose clock is ``tokens`` charges the seat for it."""

    def spent(self) -> Spent:
        """Return what it has spent so far. It is called with every answer, so it must be quick."""
        ...


class Purse:
    """Counts what a seat has spent on thinking since its match began, in whole numbers."""

    def __init__(self) -> None:
        self._spending: Spending | None = None
        self._before = 0, 0  # tokens and ns that were spent before
        self.tokens = 0
        self.processor = 0  # ns

    def count(self, spending: Spending) -> None:
        """Count from now on what something says that the seat spends."""
        self._spending = spending
        self.begin()

    def begin(self) -> None:
        """Leave out all that was spent before now and not taken."""
        tokens, processor = self._total()
        self._before = tokens - self.tokens, processor - self.processor

    def take(self) -> tuple[int, int]:
        """Return the tokens and the ns of a processor that were spent since this was last called."""
        tokens, processor = self._total()
        new = tokens - self._before[0] - self.tokens, processor - self._before[1] - self.processor
        new = max(0, new[0]), max(0, new[1])
        self.tokens, self.processor = self.tokens + new[0], self.processor + new[1]
        return new

    def _total(self) -> tuple[int, int]:
        if self._spending is None:
            return 0, 0
        spent = self._spending.spent()
        return spent.tokens, round(spent.processor * 1e9)
