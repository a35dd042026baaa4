"""Sensors that are a few numbers about an agent: what a kernel reads from the state.

A number that agents are to be told besides those of the protocol's ``Observation`` is such a sensor. It has
columns and a kernel, and everything else follows from these: the space of environments, the tensor that
agents get, the tables of the documentation. In environments one call reads it for all matches.
"""

import functools
from abc import abstractmethod
from collections.abc import Callable, Sequence
from types import FunctionType
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.sensors.base import Column, Sensor, row_space, rows_of
from wildscav_engine.simulation.state import Agents, Matches, State

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.simulation.match_view import MatchView

# Writes the numbers of one seat: the agents and matches of a batch, which match, which seat, and the row.
Write = Callable[[Agents, Matches, int, int, NDArray[np.float32]], None]


class ScalarSensor(Sensor):
    """A few numbers about an agent."""

    scalars: ClassVar[tuple[Column, ...]]

    @staticmethod
    @abstractmethod
    def kernel() -> Write:
        """Return the kernel that writes the numbers of one seat into a row of zeros, in order."""

    @property
    def columns(self) -> tuple[Column, ...]:
        """The columns of a reading."""
        return self.scalars

    @property
    def space(self) -> "Box":
        """(columns,)."""
        return row_space(self.scalars)

    def read(self, match: "MatchView", seats: Sequence[int]) -> NDArray[np.float32]:
        """Return (len(seats), columns).

        Raises:
            ValueError: The match has no such seat.
        """
        readings: NDArray[np.float32] = self.read_all(match.state, rows_of(match, seats))[0]
        return readings

    def read_all(self, state: State, seats: NDArray[np.int64]) -> NDArray[np.float32]:
        """Return (B, len(seats), columns) readings of the same seats in all matches."""
        readings = np.zeros((len(state.matches.frame), len(seats), len(self.scalars)), np.float32)
        reader_of(self.kernel())(state.agents, state.matches, seats, readings)
        return readings


def _write(agents: Agents, matches: Matches, match: int, seat: int, row: NDArray[np.float32]) -> None:
    """Stand for the kernel of a sensor."""


def _read(agents: Agents, matches: Matches, seats: NDArray[np.int64], readings: NDArray[np.float32]) -> None:
    for match in range(readings.shape[0]):
        for place in range(readings.shape[1]):
            _write(agents, matches, match, seats[place], readings[match, place])


@functools.cache
def reader_of(write: Write) -> Callable[[Agents, Matches, NDArray[np.int64], NDArray[np.float32]], None]:
    """Return the kernel that reads some seats of all matches, made for one sensor's kernel.

    It counts as part of the file of that kernel, so that it is compiled anew whenever that one is.
    """
    plain: Any = getattr(write, "__wrapped__", write)
    home, name = plain.__code__, f"read_by_{plain.__qualname__}"
    code = _read.__code__.replace(
        co_filename=home.co_filename, co_firstlineno=home.co_firstlineno, co_name=name, co_qualname=name
    )
    reader: Any = FunctionType(code, {**globals(), "__name__": plain.__module__, "_write": write}, name)
    return kernel(reader)
