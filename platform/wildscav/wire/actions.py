"""Actions: from the SDK into messages, and from messages into rows of numbers."""

import math
from collections.abc import Sequence
from operator import attrgetter
from typing import NamedTuple

from wildscav.agent import ACTION_FIELDS, Action
from wildscav.proto.match_pb2 import Action as ActionMessage
from wildscav.proto.match_pb2 import ClientMessage

MAX_WALK_SPEED = 10.0  # m/s
FULL_TURN = 360.0  # degrees

_values_of = attrgetter(*ACTION_FIELDS)


def encode_action(step: int, action: Action) -> ClientMessage:
    """Return the message that answers the observation of a step."""
    message = ClientMessage()
    fields = message.action
    fields.step = step
    for name in ACTION_FIELDS:
        setattr(fields, name, getattr(action, name))
    return message


class DecodedAction(NamedTuple):
    """A checked action."""

    row: list[float] | None  # a number for each of ACTION_FIELDS; None if a number was out of range
    ignored: int  # number of fields that were set although the track does not have them


INVALID = DecodedAction(None, 0)


def decode_action(message: ActionMessage, outside: Sequence[int]) -> DecodedAction:
    """Check an action and return its row.

    Args:
        outside: The columns that are not in the track's action set; they are set to zero.
    """
    row = [*map(float, _values_of(message))]
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
