"""The base classes of sensors that read all matches of a batch in one call."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.sensors.base import Column, Sensor, rows_of, table_space

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.simulation.match_view import MatchView
    from wildscav_engine.simulation.state import State
    from wildscav_engine.simulation.systems.visibility import Seen


class BatchedSensor(Sensor):
    """A sensor that needs only the state and what is seen, not the map of a match."""

    @abstractmethod
    def read_batch(self, state: "State", seen: "Seen", seats: NDArray[np.int64]) -> NDArray[Any]:
        """Return (B, len(seats), *space.shape) readings of the same seats in all matches.

        Args:
            state: The state of B matches.
            seen: What each agent of them sees now.
            seats: The numbers of the seats, which all matches have.
        """

    def read(self, match: "MatchView", seats: Sequence[int]) -> NDArray[Any]:
        """Return (len(seats), *space.shape) readings of some seats of a match.

        Raises:
            ValueError: The match has no such seat.
        """
        readings: NDArray[Any] = self.read_batch(match.state, match.seen, rows_of(match, seats))[0]
        return readings


class TableSensor(BatchedSensor):
    """A sensor that lists things: each fills a row of ``table``, and unused rows are 0."""

    table: ClassVar[tuple[Column, ...]]
    limit: int  # rows

    @property
    def columns(self) -> tuple[Column, ...]:
        """The columns of a row."""
        return self.table

    @property
    def space(self) -> "Box":
        """(limit, columns)."""
        return table_space(self.limit, self.columns)
