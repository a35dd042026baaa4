"""Tools that walk: to a bearing, a box or a place; to where nobody looked yet."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from wildscav.agent import Vector
from wildscav.geometry import flat_distance, moved
from wildscav_language.body import Body
from wildscav_language.calls import Order, Reason, RefusedCallError, Steps, StopFor, Tool
from wildscav_language.tools.looking import Bearing, Seconds

FAR = 1000.0  # m, how far a bearing leads
AT_PLACE = 2.0  # m from a place, at which one has arrived
STUCK_TIME = 4.0  # s in which a walk must lead somewhere
STUCK_WAY = 2.0  # m
HOPELESS = 20.0  # s in which a walk to a place must come nearer to it
Stops = Annotated[
    tuple[StopFor, ...], Field(description="what ends the walk early: being hit, a new enemy, a new box")
]


class Go(Order):
    """Walk; give one of bearing, box and place."""

    bearing: Bearing | None = None
    box: Annotated[int | None, Field(description="the number of a known box")] = None
    place: Annotated[str | None, Field(max_length=20, description="a place's name, such as target")] = None
    seconds: Seconds = 15.0
    stop_for: Stops = ("hit", "enemy")

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        if sum(goal is not None for goal in (self.bearing, self.box, self.place)) != 1:
            raise ValueError("give exactly one of bearing, box and place")
        return self


class Explore(Order):
    """Walk to where this seat has not looked yet."""

    seconds: Seconds = 20.0
    stop_for: Stops = ("hit", "enemy", "box")


class PickUp(Order):
    """Fetch a box."""

    box: Annotated[int | None, Field(description="the number of a known box; none: whichever is nearest")] = (
        None
    )
    seconds: Seconds = 15.0
    stop_for: Stops = ("hit", "enemy")


class Progress:
    """Notices that a walk leads nowhere."""

    def __init__(self, body: Body) -> None:
        self.trail = [body.now.position]
        self.steps = max(1, round(STUCK_TIME / body.match.step_time))
        self.nearest, self.nearer_at = float("inf"), body.now.time

    def is_stuck(self, body: Body, goal: Vector | None) -> bool:
        """Return whether the body stays where it is, or comes no nearer to a goal."""
        here, now = body.now.position, body.now.time
        self.trail = [*self.trail[-self.steps :], here]
        if len(self.trail) > self.steps and flat_distance(self.trail[0], here) < STUCK_WAY:
            return True
        if goal is None:
            return False
        left = flat_distance(here, goal)
        if left < self.nearest - 1.0:
            self.nearest, self.nearer_at = left, now
        return now - self.nearer_at > HOPELESS


def go(body: Body, order: Go) -> Steps:
    """Walk to a goal."""
    if order.bearing is not None:
        return (yield from walk(body, None, order.bearing, order.seconds, order.stop_for))
    if order.box is not None:
        return (yield from fetch(body, order.box, order.seconds, order.stop_for))
    place = body.memory.place(order.place or "")
    if place is None:
        known = ", ".join(body.memory.places())
        raise RefusedCallError(f"There is no such place; known places are {known or 'none yet'}.")
    return (yield from walk(body, place, 0.0, order.seconds, order.stop_for))


def walk(
    body: Body, goal: Vector | None, bearing: float, seconds: float, stop_for: tuple[StopFor, ...]
) -> Steps:
    """Walk to a place, or in a direction, for some seconds at most."""
    end, progress = body.now.time + seconds, Progress(body)
    near = min(AT_PLACE, 0.5 * body.match.target_distance) if goal == body.now.target else AT_PLACE
    while True:
        here = body.now.position
        if goal is not None and flat_distance(here, goal) < near and abs(goal[1] - here[1]) < AT_PLACE:
            return Reason.ARRIVED, ""
        yield body.walking_to(goal if goal is not None else moved(here, bearing, FAR))
        if reason := body.interruption(stop_for):
            return reason
        if progress.is_stuck(body, goal):
            return Reason.STUCK, "No way on was found."
        if body.now.time >= end - 1e-9:
            return Reason.OUT_OF_TIME, ""


def fetch(body: Body, number: int, seconds: float, stop_for: tuple[StopFor, ...]) -> Steps:
    """Walk to a box, and take what is within reach on the way."""
    if number not in body.memory.boxes:
        known = ", ".join(map(str, list(body.memory.boxes)[:20]))
        raise RefusedCallError(f"Box {number} is not known; known boxes are {known or 'none yet'}.")
    end, progress = body.now.time + seconds, Progress(body)
    while number in body.memory.boxes:
        box = body.memory.boxes[number]
        yield body.fetching(box)
        if reason := body.interruption(stop_for):
            return reason
        if number in body.memory.boxes and progress.is_stuck(body, box.position):
            return Reason.STUCK, f"No way to box {number} was found."
        if body.now.time >= end - 1e-9:
            return Reason.OUT_OF_TIME, ""
    if number in body.memory.taken:
        return Reason.DONE, f"You have what was in box {number}."
    return Reason.DONE, f"Box {number} is gone."


def pick_up(body: Body, order: PickUp) -> Steps:
    """Fetch a box, by its number or because it is near."""
    number = order.box if order.box is not None else body.memory.nearest_box(body.now.position)
    if number is None:
        if not body.now.can_pick_up:
            raise RefusedCallError("No box is known and none is within reach; look around or explore.")
        yield body.standing()
        return Reason.DONE, ""
    return (yield from fetch(body, number, order.seconds, order.stop_for))


def explore(body: Body, order: Explore) -> Steps:
    """Walk to places not visited yet, until something is found."""
    end, progress = body.now.time + order.seconds, Progress(body)
    while True:
        yield body.exploring()
        if reason := body.interruption(order.stop_for):
            return reason
        if progress.is_stuck(body, None):
            return Reason.STUCK, "No way on was found."
        if body.now.time >= end - 1e-9:
            return Reason.OUT_OF_TIME, ""


GO = Tool(
    "go",
    "Walk to a bearing, a known box or a named place, past what is in the way, for some seconds at most. "
    "Boxes within reach are picked up on the way.",
    Go,
    go,
)
EXPLORE = Tool("explore", "Walk to places that you have not visited yet.", Explore, explore)
PICK_UP = Tool("pick_up", "Walk to a box and take what is in it.", PickUp, pick_up)
