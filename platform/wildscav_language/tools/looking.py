"""Tools that stay in place: looking around, turning, waiting."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from wildscav.geometry import turn_to
from wildscav_language.body import Body
from wildscav_language.calls import Order, Reason, Steps, Tool

STEADY = 1.0  # degrees off a bearing, at which a turn is done
Seconds = Annotated[float, Field(ge=0.1, le=60.0, description="seconds of game time at most")]
Bearing = Annotated[float, Field(ge=-360.0, le=360.0, description="compass degrees: 0 is north, 90 is east")]


class LookAround(Order):
    """Turn once around, to see what is there."""


class Turn(Order):
    """Turn the view; give one of the two."""

    bearing: Bearing | None = None
    right: Annotated[
        float | None, Field(ge=-360.0, le=360.0, description="degrees from the view; negative is left")
    ] = None

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        if (self.bearing is None) == (self.right is None):
            raise ValueError("give either bearing or right")
        return self


class WaitUntil(Order):
    """Stand and wait."""

    event: Annotated[
        Literal["hit", "enemy", "box", "wave", "respawn"] | None,
        Field(description="what to wait for; nothing: until the seconds are over"),
    ] = None
    seconds: Seconds = 5.0


def look_around(body: Body, _: LookAround) -> Steps:
    """Turn by 360 degrees."""
    left = 360.0
    while left > STEADY:
        turn = min(left, body.turn_in_step)
        left -= turn
        yield body.turning(turn)
    return Reason.DONE, ""


def turn(body: Body, order: Turn) -> Steps:
    """Turn to a bearing."""
    goal = order.bearing if order.bearing is not None else body.now.yaw + (order.right or 0.0)
    while True:
        left = turn_to(body.now.yaw, goal)
        if abs(left) < STEADY:
            return Reason.DONE, ""
        yield body.turning(left)


def wait_until(body: Body, order: WaitUntil) -> Steps:
    """Stand until something happens."""
    end = body.now.time + order.seconds
    waves = body.waves_begun
    while True:
        yield body.standing()
        if order.event in ("hit", "enemy", "box") and (reason := body.interruption((order.event,))):
            return reason
        if order.event == "wave" and body.waves_begun > waves:
            return Reason.DONE, "Supplies have appeared."
        if order.event == "respawn" and body.now.alive:
            return Reason.DONE, ""
        if body.now.time >= end - 1e-9:
            return (Reason.DONE if order.event is None else Reason.OUT_OF_TIME), ""


LOOK_AROUND = Tool(
    "look_around",
    "Turn once around. It takes about a second, and shows what is behind.",
    LookAround,
    look_around,
)
TURN = Tool("turn", "Turn the view to a bearing, or by degrees to the right.", Turn, turn)
WAIT_UNTIL = Tool("wait_until", "Stand and wait for an event, or for some seconds.", WaitUntil, wait_until)
