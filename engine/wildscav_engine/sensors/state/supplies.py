"""Supply boxes as arrays, in the axes of the world and as networks can use them; see ``places.py``."""

from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.arithmetic.elementary_functions import logarithm
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.compilation.tables.array_tables import Addresses
from wildscav_engine.sensors.base import Column, Sight, StateSensor, sensor
from wildscav_engine.sensors.state.places import write_direction
from wildscav_engine.simulation.state import agents_at, supplies_at
from wildscav_engine.simulation.systems.visibility import SUPPLY_LIMIT

if TYPE_CHECKING:
    from wildscav_engine.simulation.state import State
    from wildscav_engine.simulation.systems.visibility import Seen

MAX_SUPPLIES = 2.0**31  # in a box: the bound of a 32-bit count
CLIMB = 4.0  # m of level walking that take as long as a metre of height, by stairs


@sensor
class NearbySupplies(StateSensor):
    """The nearest supply boxes: what ``supply_boxes`` of an observation lists.

    Each row describes one box, nearest first. Obstacles do not hide boxes from the original ``senses``. Boxes
    farther away than the rule ``supply_sight`` are never listed, whatever ``range`` is.
    """

    name: ClassVar[str] = "nearby_supplies"
    sight: ClassVar[Sight] = "own"
    title: ClassVar[str] = "nearby supply boxes: present, quantity, position from the soles, m, distance, m"

    range: Annotated[float, Field(gt=0, le=200)] = 20.0  # m, nothing farther is listed
    limit: Annotated[int, Field(ge=1, le=SUPPLY_LIMIT)] = SUPPLY_LIMIT  # rows: boxes, the nearest ones

    @property
    def columns(self) -> tuple[Column, ...]:
        """The columns of a row."""
        reach = self.range
        return (
            Column("present", "0 or 1", 0.0, 1.0, "whether the row describes a box"),
            Column("quantity", "", 0.0, MAX_SUPPLIES, "supplies in the box"),
            Column("x", "m", -reach, reach, "position east of the agent's soles"),
            Column("y", "m", -reach, reach, "position above the agent's soles"),
            Column("z", "m", -reach, reach, "position north of the agent's soles"),
            Column("distance", "m", 0.0, reach, "distance from the agent's soles"),
        )

    def read_batch(self, state: "State", seen: "Seen", seats: NDArray[np.int64]) -> NDArray[np.float32]:
        """Return (B, len(seats), limit, 6)."""
        agents, boxes, _ = state.tables
        readings = np.zeros((len(seen.supplies), len(seats), self.limit, 6), np.float32)
        tables = agents.addresses, boxes.addresses
        _write_boxes(seen.supplies, seen.supply_count, *tables, self.range, seats, readings)
        return readings


@kernel
def _write_boxes(
    slots: NDArray[np.int32],
    count: NDArray[np.int32],
    agents: Addresses,
    supplies: Addresses,
    reach: float,
    seats: NDArray[np.int64],
    readings: NDArray[np.float32],
) -> None:
    """Write what some seats, (S,), of all matches see of supply boxes, into zeros (B, S, limit, 6).

    ``slots`` and ``count`` are as in ``Seen``, two are tables, and ``reach``, in m, is the option ``range``.
    """
    position, boxes = agents_at(agents).position, supplies_at(supplies)
    for match in range(readings.shape[0]):
        for reader in range(seats.shape[0]):
            own = position[match, seats[reader]]
            for place in range(min(readings.shape[2], count[match, seats[reader]])):
                slot, row = slots[match, seats[reader], place], readings[match, reader, place]
                box = boxes.position[match, slot]
                x, y, z = box[0] - own[0], box[1] - own[1], box[2] - own[2]
                distance = np.sqrt(x * x + y * y + z * z)
                if distance <= reach:
                    row[0], row[1] = 1.0, boxes.quantity[match, slot]
                    row[2], row[3], row[4], row[5] = x, y, z, distance


@sensor
class ToSupplies(StateSensor):
    """The ways to the supply boxes that are most worth a walk, relative to the agent's yaw.

    Each row describes one box. Obstacles do not hide boxes from the original ``senses``.

    The first row has the box with the least effort relative to its worth, (s + d + 4 |h|) / q^w, where s is
    the option ``start_up``, d the horizontal distance (m), h the height (m), q the supplies in it, and w the
    option ``worth``.
    """

    name: ClassVar[str] = "to_supplies"
    sight: ClassVar[Sight] = "own"
    title: ClassVar[str] = (
        "the ways to the boxes most worth a walk: present; right, ahead, of 1; up, m; log distance, ln m; "
        "log quantity"
    )
    scalars: ClassVar[tuple[Column, ...]] = (
        Column("present", "0 or 1", 0, 1, "whether the row describes a box"),
        Column("right", "of 1", -1, 1, "the way there: its part to the right of the yaw"),
        Column("ahead", "of 1", -1, 1, "the same way's part along the yaw"),
        Column("up", "m", -np.inf, np.inf, "its height above the agent's soles"),
        Column("log distance", "ln m", 0, 10, "logarithm of 1 m + the horizontal distance"),
        Column("log quantity", "", 0, 22, "logarithm of 1 + the supplies in it"),
    )

    limit: Annotated[int, Field(ge=1, le=SUPPLY_LIMIT)] = 3  # rows: boxes, those most worth a walk
    worth: Annotated[float, Field(ge=0, le=2)] = 0.6  # exponent of the supplies; 0: the nearest first
    start_up: Annotated[float, Field(ge=0, le=100)] = 3.0  # m added to every way: even a near box takes time

    def read_batch(self, state: "State", seen: "Seen", seats: NDArray[np.int64]) -> NDArray[np.float32]:
        """Return (B, len(seats), limit, 6)."""
        agents, boxes, _ = state.tables
        readings = np.zeros((len(seen.supplies), len(seats), self.limit, len(self.scalars)), np.float32)
        tables, costs = (agents.addresses, boxes.addresses), np.empty(SUPPLY_LIMIT)
        _write_ways(
            *(seen.supplies, seen.supply_count, *tables, self.worth, self.start_up, seats, costs, readings)
        )
        return readings


@kernel
def _write_ways(
    slots: NDArray[np.int32],
    count: NDArray[np.int32],
    agents: Addresses,
    supplies: Addresses,
    worth: float,
    start_up: float,
    seats: NDArray[np.int64],
    costs: NDArray[np.float64],
    readings: NDArray[np.float32],
) -> None:
    """Write the ways of some seats, (S,), of all matches to boxes, into zeros (B, S, limit, columns).

    ``slots`` and ``count`` are as in ``Seen``, two are tables, ``worth`` and ``start_up`` are options, and
    ``costs`` is scratch (32,) for the logarithms of effort relative to worth.
    """
    position, yaw = agents_at(agents).position, agents_at(agents).yaw
    place_of_box, quantity = supplies_at(supplies).position, supplies_at(supplies).quantity
    for match in range(readings.shape[0]):
        for reader in range(seats.shape[0]):
            seat = seats[reader]
            own, boxes = position[match, seat], slots[match, seat, : count[match, seat]]
            for place in range(boxes.shape[0]):
                box = place_of_box[match, boxes[place]]
                x, y, z = box[0] - own[0], box[1] - own[1], box[2] - own[2]
                effort = start_up + np.sqrt(x * x + z * z) + CLIMB * abs(y)
                # A box at one's feet without a start-up costs nothing.
                cost = logarithm(effort) if effort > 0.0 else -np.inf
                costs[place] = cost - worth * logarithm(float(quantity[match, boxes[place]]))
            for written in range(min(readings.shape[2], boxes.shape[0])):
                best = np.argmin(costs[: boxes.shape[0]])
                costs[best] = np.inf
                box, held = place_of_box[match, boxes[best]], quantity[match, boxes[best]]
                _write_way(own, yaw[match, seat], box, held, readings[match, reader, written])


@kernel
def _write_way(
    own: NDArray[np.float64], yaw: float, box: NDArray[np.float32], quantity: int, row: NDArray[np.float32]
) -> None:
    """Write (6,) the way from a position to a box."""
    x, y, z = box[0] - own[0], box[1] - own[1], box[2] - own[2]
    level = write_direction(x, z, yaw, row[1:3])
    row[0], row[3], row[4], row[5] = 1.0, y, logarithm(1.0 + level), logarithm(1.0 + float(quantity))
