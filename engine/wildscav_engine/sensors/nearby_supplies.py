"""The nearby supply boxes as an array: what ``supply_boxes`` of an observation lists.

Each row describes one box, nearest first: 1, the supplies in it, its position relative to the agent's soles
in the axes of the world (x east, y up, z north, m), and its distance (m). Unused rows are 0. Obstacles do not
hide boxes. Boxes farther away than the rule ``supply_sight`` are never listed, whatever ``range`` is.
"""

from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.sensors.base import Column, sensor
from wildscav_engine.sensors.batched import TableSensor
from wildscav_engine.simulation.systems.visibility import SUPPLY_LIMIT

if TYPE_CHECKING:
    from wildscav_engine.simulation.state import State
    from wildscav_engine.simulation.systems.visibility import Seen

MAX_SUPPLIES = 2.0**31  # in a box: the bound of a 32-bit count


@sensor
class NearbySupplies(TableSensor):
    """The nearest supply boxes."""

    name: ClassVar[str] = "nearby_supplies"
    title: ClassVar[str] = "nearby supply boxes: present, quantity, position from the soles, m, distance, m"

    range: Annotated[float, Field(gt=0, le=200)] = 20.0  # m
    limit: Annotated[int, Field(ge=1, le=SUPPLY_LIMIT)] = SUPPLY_LIMIT  # rows

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
        boxes, position = state.supplies, state.agents.position
        readings = np.zeros((len(seen.supplies), len(seats), self.limit, 6), np.float32)
        _write_boxes(
            *(seen.supplies, seen.supply_count, boxes.position, boxes.quantity),
            *(position, self.range, seats, readings),
        )
        return readings


@kernel
def _write_boxes(
    slots: NDArray[np.int32],
    count: NDArray[np.int32],
    place_of_box: NDArray[np.float32],
    quantity: NDArray[np.int32],
    position: NDArray[np.float64],
    reach: float,
    seats: NDArray[np.int64],
    readings: NDArray[np.float32],
) -> None:
    """Write what some seats, (S,), of all matches see of supply boxes, into zeros (B, S, limit, 6).

    Everything else is as in ``Seen``, ``Supplies`` and ``Agents``; ``reach``, in m, is the option ``range``.
    """
    for match in range(readings.shape[0]):
        for reader in range(seats.shape[0]):
            own = position[match, seats[reader]]
            for place in range(min(readings.shape[2], count[match, seats[reader]])):
                slot, row = slots[match, seats[reader], place], readings[match, reader, place]
                x = place_of_box[match, slot, 0] - own[0]
                y = place_of_box[match, slot, 1] - own[1]
                z = place_of_box[match, slot, 2] - own[2]
                distance = np.sqrt(x * x + y * y + z * z)
                if distance <= reach:
                    row[0], row[1] = 1.0, quantity[match, slot]
                    row[2], row[3], row[4], row[5] = x, y, z, distance
