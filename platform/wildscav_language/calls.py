"""What a call is: a tool with the model of its arguments, the steps that it plays, and why it ends."""

from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, ValidationError

from wildscav.agent import Action

SHOWN = 60  # characters of a wrong argument that an answer repeats


class Reason(StrEnum):
    """Why a tool ended."""

    DONE = "done"  # it did what it is for
    ARRIVED = "arrived"  # the walk came to its goal
    STUCK = "stuck"  # the body moved less than 2 m in 4 s, or came no nearer to its goal for 20 s
    HIT = "hit"  # the body was shot
    ENEMY_SEEN = "enemy_seen"  # an enemy came into sight that was not before
    BOX_SEEN = "box_seen"  # a box was found that was not known before
    OUT_OF_TIME = "out_of_time"  # the seconds that the call allowed are over
    DIED = "died"  # the agent died; calls of the dead last until they come back
    MATCH_OVER = "match_over"  # the match is over, or the seat has left it
    REFUSED = "refused"  # the call could not be understood or played
    PLAYING = "playing"  # it has not ended, but the caller did not wait longer; Seat.wait() returns its reply


End: TypeAlias = tuple[Reason, str]  # why, and a sentence more, or ""
Steps: TypeAlias = Generator[Action, None, End]  # an action for each step, then the end
StopFor: TypeAlias = Literal["hit", "enemy", "box"]


class RefusedCallError(Exception):
    """A call cannot be played; the message is one sentence that says what is allowed."""


class Order(BaseModel):
    """Base of the arguments of tools."""

    model_config = ConfigDict(extra="forbid", frozen=True)


@dataclass(frozen=True, slots=True)
class Tool:
    """Something that a seat may do, for many steps."""

    name: str
    description: str
    order: type[Order]  # the model of its arguments
    play: Callable[[Any, Any], Steps]  # of a body and an order

    @property
    def schema(self) -> dict[str, Any]:
        """The JSON schema of the arguments."""
        return self.order.model_json_schema()

    def begin(self, body: object, arguments: Mapping[str, Any]) -> Steps:
        """Return the steps of a call.

        Raises:
            RefusedCallError: The arguments are not what the schema says.
        """
        try:
            order = self.order.model_validate(dict(arguments))
        except ValidationError as error:
            raise RefusedCallError(self._said_of(error)) from None
        return self.play(body, order)

    def _said_of(self, error: ValidationError) -> str:
        """Return a sentence about the first thing that is wrong with the arguments."""
        first = error.errors(include_url=False, include_context=False)[0]
        where = ".".join(str(part)[:SHOWN] for part in first["loc"]) or "the arguments"
        given = repr(first["input"])
        shown = given if len(given) <= SHOWN else f"{given[:SHOWN]}…"
        allowed = ", ".join(self.order.model_fields) or "no arguments"
        return f"{self.name} refuses {where} {shown}: {first['msg']}. It takes {allowed}."
