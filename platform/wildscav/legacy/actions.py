"""Translation of the client's commands into the engine's action rows."""

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

from wildscav.legacy.commander_pb2 import AgentCommand


def read_actions(
    commands: Iterable[AgentCommand], seats: Mapping[int, int]
) -> "tuple[NDArray[np.float32], list[int]]":
    """Return (A, FIELDS) the actions of all seats. Seats without a command do nothing.

    A walk speed is clamped to 0 to 10 m/s, the range that the original's agents had.

    Args:
        commands: The commands of one reply; if there are two for one agent, the last one counts.
        seats: The seat of each id.

    Returns:
        The rows, and the ids that belong to no agent.
    """
    from wildscav_engine.specs.actions import MAX_WALK_SPEED, no_actions

    rows, unknown = no_actions(len(seats)), []
    for command in commands:
        seat = seats.get(command.id)
        if seat is None:
            unknown.append(command.id)
            continue
        speed = command.walk_speed
        rows[seat] = (
            command.walk_dir,
            speed if math.isnan(speed) else min(MAX_WALK_SPEED, max(0.0, speed)),
            command.turn_left_right_delta,
            command.look_up_down_delta,
            command.jump,
            command.collect,
            command.shoot_gun,
            command.reload,
        )
    return rows, unknown
