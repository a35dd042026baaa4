"""Where another agent is and how it moves, relative to the agent that reads a sensor."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.sensors.base import Column

INF = np.inf
MOTION_COLUMNS = (
    Column("x", "m", -INF, INF, "position east of the agent's soles"),
    Column("y", "m", -INF, INF, "position above the agent's soles"),
    Column("z", "m", -INF, INF, "position north of the agent's soles"),
    Column("distance", "m", 0, INF, "distance from the agent's soles"),
    Column("velocity_x", "m/s", -INF, INF, "its velocity to the east"),
    Column("velocity_y", "m/s", -INF, INF, "its velocity upwards"),
    Column("velocity_z", "m/s", -INF, INF, "its velocity to the north"),
    Column("yaw", "degrees", -180, 180, "where it faces: 0 is north, 90 is east"),
)


@kernel
def write_motion(
    position: NDArray[np.float64],
    velocity: NDArray[np.float64],
    yaw: NDArray[np.float64],
    reader: int,
    other: int,
    row: NDArray[np.float32],
) -> None:
    """Write where an agent is and how it moves.

    Args:
        position: (A, 3) m, of all agents of a match.
        velocity: (A, 3) m/s.
        yaw: (A,) degrees.
        reader: The seat that reads the sensor.
        other: The seat of the agent.
        row: (8,) the columns of ``MOTION_COLUMNS``, written.
    """
    x = position[other, 0] - position[reader, 0]
    y = position[other, 1] - position[reader, 1]
    z = position[other, 2] - position[reader, 2]
    row[0], row[1], row[2] = x, y, z
    row[3] = np.sqrt(x * x + y * y + z * z)
    for axis in range(3):
        row[4 + axis] = velocity[other, axis]
    row[7] = yaw[other]
