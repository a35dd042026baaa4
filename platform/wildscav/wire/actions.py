"""Actions: from the SDK into messages, and from messages into rows of numbers."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from wildscav.agent import Action
from wildscav.proto.match_pb2 import Action as ActionMessage
from wildscav.proto.match_pb2 import ClientMessage

# The order of the columns in the engine's action rows; also the names in the protocol and the SDK.
ACTION_FIELDS = ("walk_direction", "walk_speed", "turn", "look", "jump", "pick_up", "shoot", "reload")
MAX_WALK_SPEED = 10.0  # m/s
FULL_TURN = 360.0  # degrees


def encode_action(step: int, action: Action) -> ClientMessage:
    """Return the message that answers the observation of a step."""
    message = ClientMessage()
    fields = message.action
    fields.step = step
    fields.walk_direction = action.walk_direction
    fields.walk_speed = action.walk_speed
    fields.turn = action.turn
    fields.look = action.look
    fields.jump = action.jump
    fields.pick_up = action.pick_up
    fields.shoot = action.shoot
    fields.reload = action.reload
    return message


class DecodedAction(NamedTuple):
    """A checked action."""

    row: list[float] | None  # a number for each of ACTION_FIELDS; None if a number was out of range
    ignored: int  # number of fields that were set although the track does not have them


INVALID = DecodedAction(None, 0)


def decode_action(message: ActionMessage, outside: Sequence[int]) -> DecodedAction:
    """Check an action and return its row.

    Args:
        message: The agent's message.
        outside: The columns that are not in the track's action set; they are set to zero.
    """
    row = [
        message.walk_direction,
        message.walk_speed,
        message.turn,
        message.look,
        float(message.jump),
        float(message.pick_up),
        float(message.shoot),
        float(message.reload),
    ]
    # Written so that NaN fails too. Protobuf has turned numbers too large for 32 bits into infinity.
    if not (0.0 <= row[1] <= MAX_WALK_SPEED and math.isfinite(row[0] + row[2] + row[3])):
        return INVALID
    if max(map(abs, row)) > FULL_TURN:
        _reduce_angles(row)
    ignored = 0
    for column in outside:
        if row[column]:
            row[column] = 0.0
            ignored += 1
    return DecodedAction(row, ignored)


def _reduce_angles(row: list[float]) -> None:
    """Replace large angles with equivalent small ones, exactly, also in 32 bits."""
    row[0] = math.fmod(row[0], FULL_TURN)
    row[2] = math.fmod(row[2], FULL_TURN)
    # The pitch is clamped to [-90, 90], so half a turn reaches its limit from anywhere.
    row[3] = max(-FULL_TURN, min(FULL_TURN, row[3]))
