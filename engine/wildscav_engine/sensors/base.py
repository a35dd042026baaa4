"""The base classes of sensors. A sensor is an object whose fields are its options."""

import functools
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import fields
from typing import (
    TYPE_CHECKING,
    Any,
    ClassVar,
    Literal,
    NamedTuple,
    TypeVar,
    cast,
    dataclass_transform,
    get_args,
    get_origin,
)

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict, ValidationError
from pydantic.dataclasses import dataclass

from wildscav_engine.specs.validation import one_line

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.maps.game_map import GameMap
    from wildscav_engine.simulation.match_view import MatchView
    from wildscav_engine.simulation.state import State
    from wildscav_engine.simulation.systems.visibility import Seen

CONFIG = ConfigDict(extra="forbid", allow_inf_nan=False)


Sight = Literal["none", "own", "all"]


class Column(NamedTuple):
    """One number of a sensor reading or of a learner's observation."""

    name: str
    unit: str  # "" for a plain number
    low: float
    high: float
    meaning: str  # a phrase for the tables of the documentation


class Sensor(ABC):
    """Base class of sensors: reads one array per seat from a match, without changing the match."""

    name: ClassVar[str]  # in submission.toml, and of the tensor in observations
    title: ClassVar[str]  # one line, with the unit

    @property
    @abstractmethod
    def space(self) -> "Box":
        """The shape, type and bounds of one seat's reading."""

    @abstractmethod
    def read(self, match: "MatchView", seats: Sequence[int]) -> NDArray[Any]:
        """Return the readings of some seats, (len(seats), *space.shape).

        Raises:
            ValueError: The match has no such seat.
        """

    @property
    def columns(self) -> tuple[Column, ...]:
        """The meaning of the numbers along the last axis of a reading; empty for images."""
        return ()

    @property
    def rays(self) -> int:
        """The number of rays that one reading casts, a measure of its cost."""
        return 0

    def prepare(self, game_map: "GameMap") -> None:  # noqa: B027  # most sensors need nothing
        """Compute in advance what readings on a map need and what takes longer than one reading."""

    @classmethod
    def warmers(cls) -> "Sequence[Sensor]":
        """Return sensors of this kind that together run all its kernels: one for each value of a choice.

        Choices are options of type bool or ``Literal``. Options that are numbers do not change which kernels
        run.
        """
        choices = [(field.name, choice) for field in fields(cls) for choice in _choices(field.type)]  # type: ignore[arg-type]
        return [cls(), *(cls(**{name: choice}) for name, choice in choices)]


class StateSensor(Sensor):
    """A sensor of numbers that needs only the state and what is seen, not the map of a match.

    So one call reads all matches of a vector environment. A reading is a row of ``scalars``; or a table of
    such rows, whose unused rows are 0, if the sensor has the option ``limit``, their number.
    """

    scalars: ClassVar[tuple[Column, ...]]
    # Which agents' sight a reading of some seats needs; environments do not find out what others see.
    sight: ClassVar[Sight] = "all"

    @property
    def columns(self) -> tuple[Column, ...]:
        """The columns of a row."""
        return self.scalars

    @property
    def space(self) -> "Box":
        """(columns,), or (limit, columns)."""
        row, limit = row_space(self.columns), getattr(self, "limit", None)
        if limit is None:
            return row
        return type(row)(np.tile(row.low, (limit, 1)), np.tile(row.high, (limit, 1)), dtype=np.float32)

    @abstractmethod
    def read_batch(self, state: "State", seen: "Seen", seats: NDArray[np.int64]) -> NDArray[np.float32]:
        """Return (B, len(seats), *space.shape) readings of the same seats in all matches.

        Args:
            state: The state of B matches.
            seen: What the agents of them see now, as far as ``sight`` says.
            seats: The numbers of the seats, which all matches have.
        """

    def read(self, match: "MatchView", seats: Sequence[int]) -> NDArray[np.float32]:
        """Return (len(seats), *space.shape) readings of some seats of a match.

        Raises:
            ValueError: The match has no such seat.
        """
        readings: NDArray[np.float32] = self.read_batch(match.state, match.seen, rows_of(match, seats))[0]
        return readings


def row_space(columns: Sequence[Column]) -> "Box":
    """Return the space of one row of numbers."""
    from gymnasium.spaces import Box

    low = np.array([column.low for column in columns], np.float32)
    return Box(low, np.array([column.high for column in columns], np.float32), dtype=np.float32)


def rows_of(match: "MatchView", seats: Sequence[int]) -> NDArray[np.int64]:
    """Return seats as row indices of the state's arrays.

    Raises:
        ValueError: The match has no such seat.
    """
    for seat in seats:
        if not 0 <= seat < match.seats:
            raise ValueError(f"there is no seat {seat}; the seats are 0 to {match.seats - 1}")
    return _row_of(int(seats[0])) if len(seats) == 1 else np.array(seats, np.int64)


@functools.lru_cache(maxsize=1024)
def _row_of(seat: int) -> NDArray[np.int64]:
    """Return a single seat as a row index, which nobody changes."""
    return np.array([seat])


def _choices(kind: object) -> tuple[object, ...]:
    """Return the possible values of an option of type bool or ``Literal``, otherwise none."""
    if kind is bool:
        return (False, True)
    return get_args(kind) if get_origin(kind) is Literal else ()


def check_sensor(name: str, kind: Any) -> type[Sensor]:
    """Return a kind of sensor as an entry point names it.

    Raises:
        ValueError: It is not a class of sensors.
    """
    if not isinstance(kind, type) or not issubclass(kind, Sensor):
        raise ValueError("it is no class that derives from Sensor")
    missing = [attribute for attribute in ("name", "title") if not hasattr(kind, attribute)]
    missing += sorted(kind.__abstractmethods__)
    if missing:
        raise ValueError(f"its class {kind.__name__} has no {', '.join(missing)}")
    if "__dataclass_fields__" not in vars(kind):
        raise ValueError(f"its class {kind.__name__} is not decorated with @sensor")
    if kind.name != name:
        raise ValueError(f"its class is called {kind.name!r}")
    return kind


SensorType = TypeVar("SensorType", bound=Sensor)


@dataclass_transform(frozen_default=True)
def sensor(kind: type[SensorType]) -> type[SensorType]:
    """Turn a class into a sensor: its fields become options, which are validated on construction.

    An unknown option or a value that is not allowed raises a ValueError. Its message is one line that names
    the option and says what is wrong and what is allowed.
    """
    made = dataclass(frozen=True, config=CONFIG)(kind)
    construct = made.__init__
    known = [field.name for field in fields(made)]
    options = f"its options are {', '.join(known)}" if known else "it has no options"

    @functools.wraps(construct)
    def __init__(self: SensorType, /, *values: object, **named: object) -> None:  # noqa: N807
        if len(values) > len(known):
            raise ValueError(f"sensor {kind.name}: {len(values)} values are given; {options}")
        in_order = dict(zip(known, values, strict=False))
        if twice := in_order.keys() & named.keys():
            raise TypeError(f"sensor {kind.name}: {min(twice)} is given twice")
        if unknown := sorted(named.keys() - set(known)):
            raise ValueError(f"sensor {kind.name}: there is no option {unknown[0]!r}; {options}")
        try:
            construct(self, **in_order, **named)
        except ValidationError as error:
            raise ValueError(f"sensor {kind.name}: {one_line(error)} ({options})") from None

    setattr(made, "__init__", __init__)  # noqa: B010
    return cast(type[SensorType], made)
