"""What agents spend on thinking: tokens of a model's, and seconds of processors."""

from typing import NamedTuple, Protocol


class Spent(NamedTuple):
    """What a seat has spent since its agent was started. Neither number ever falls."""

    tokens: int = 0  # that its model has read and written
    processor: float = 0.0  # s in which a thread of its own ran


class Spending(Protocol):
    """Counts what a seat spends. A match whose clock is ``tokens`` charges the seat for it."""

    def spent(self) -> Spent:
        """Return what it has spent so far. It is called with every answer, so it must be quick."""
        ...
