"""Tools against other agents: following, shooting, hiding."""

from typing import Annotated

from pydantic import Field

from wildscav.agent import Action, Vector
from wildscav.geometry import direction_to, flat_distance
from wildscav.skills.fighting import cover_from
from wildscav.skills.walking import FULL_SPEED, Walk
from wildscav_language.body import Body
from wildscav_language.calls import Order, Reason, RefusedCallError, Steps, Tool
from wildscav_language.memory import Seen
from wildscav_language.tools.looking import Seconds
from wildscav_language.tools.walking import Progress, Stops

LOST = 3.0  # s out of sight, after which an agent is lost
AT_COVER = 0.6  # m

SeatNumber = Annotated[int, Field(ge=0, description="the number of an agent's seat")]


class Follow(Order):
    """Walk behind an agent."""

    agent: SeatNumber
    metres: Annotated[float, Field(ge=1.0, le=100.0, description="how near to come")] = 5.0
    seconds: Seconds = 15.0
    stop_for: Stops = ("hit",)


class Attack(Order):
    """Shoot at an enemy."""

    agent: Annotated[SeatNumber | None, Field(description="an enemy's seat; none: whichever is nearest")] = (
        None
    )
    seconds: Seconds = 10.0


class TakeCover(Order):
    """Walk to where an enemy cannot see this seat."""

    seconds: Seconds = 6.0


class NoArguments(Order):
    """No arguments."""


def follow(body: Body, order: Follow) -> Steps:
    """Walk to where an agent is, or was last seen."""
    seen_agent(body, order.agent)
    end, progress = body.now.time + order.seconds, Progress(body)
    while True:
        seen = body.memory.agents[order.agent]
        far = flat_distance(body.now.position, seen.position)
        if far <= order.metres and body.now.time - seen.time > LOST:
            return Reason.DONE, f"Agent {order.agent} is not in sight any more."
        yield body.walking_to(seen.position) if far > order.metres else body.standing_at(seen.position)
        if reason := body.interruption(order.stop_for):
            return reason
        if far > order.metres and progress.is_stuck(body, None):
            return Reason.STUCK, "No way on was found."
        if body.now.time >= end - 1e-9:
            return Reason.OUT_OF_TIME, ""


def attack(body: Body, order: Attack) -> Steps:
    """Come within range of an enemy, dodge, and shoot when a shot will hit."""
    if order.agent is None and not body.enemies:
        raise RefusedCallError("No enemy is in sight; look around, or name one that you have seen.")
    target = body.enemies[0].seat if order.agent is None else order.agent
    if body.now.clip == body.now.spare_ammo == 0:
        raise RefusedCallError("There are no rounds left.")
    if seen_agent(body, target).team == body.match.team:
        raise RefusedCallError(f"Agent {target} is of your team; attack takes enemies.")
    body.holds_fire, end, progress = False, body.now.time + order.seconds, Progress(body)
    while True:
        seen = body.memory.agents[target]
        if body.now.time - seen.time > LOST:
            return Reason.DONE, f"Agent {target} is not in sight any more."
        yield body.fighting(target)
        if progress.is_stuck(body, None):
            progress = Progress(body)
        if body.now.time >= end - 1e-9:
            return Reason.OUT_OF_TIME, ""


def take_cover(body: Body, order: TakeCover) -> Steps:
    """Walk to the nearest place that is hidden from the last enemy."""
    danger = body.memory.danger()
    if danger is None:
        raise RefusedCallError("No enemy has been seen; cover is from an enemy.")
    end = body.now.time + order.seconds
    place: Vector | None = None
    while True:
        here = body.now.position
        if place is None:
            place = cover_from(body.gathering.surroundings, here, danger)
        elif flat_distance(here, place) < AT_COVER:
            return Reason.ARRIVED, "Something hides you from where the enemy was."
        direction = direction_to(danger, here) if place is None else direction_to(here, place)
        left = FULL_SPEED if place is None else flat_distance(here, place) / body.match.step_time
        yield body.moving(Walk(direction, min(FULL_SPEED, left)))
        if body.now.time >= end - 1e-9:
            return Reason.OUT_OF_TIME, "" if place else "There is no cover nearby."


def reload(body: Body, _: NoArguments) -> Steps:
    """Reload the weapon, and wait for it."""
    if body.now.spare_ammo == 0:
        raise RefusedCallError("There are no spare rounds.")
    if body.now.clip >= body.match.clip_size:
        raise RefusedCallError(f"The clip is full with {body.now.clip} rounds.")
    yield Action(reload=True)
    while body.now.reloading:
        yield body.standing()
    return Reason.DONE, ""


def hold_fire(body: Body, _: NoArguments) -> Steps:
    """Shoot at nobody until the next attack."""
    body.holds_fire = True
    yield body.standing()
    return Reason.DONE, "You shoot at nobody until you attack."


def seen_agent(body: Body, seat: int) -> Seen:
    """Return what is known of an agent.

    Raises:
        RefusedCallError: It has never been seen.
    """
    if seat not in body.memory.agents:
        known = ", ".join(map(str, sorted(body.memory.agents)))
        raise RefusedCallError(f"Agent {seat} has not been seen; seen so far: {known or 'nobody'}.")
    return body.memory.agents[seat]


FOLLOW = Tool("follow", "Walk after an agent that you have seen.", Follow, follow)
ATTACK = Tool(
    "attack",
    "Fight an enemy: come near, dodge, aim and shoot. From then on you shoot at enemies in sight during all "
    "tools but turn and look_around, until you hold your fire.",
    Attack,
    attack,
)
TAKE_COVER = Tool("take_cover", "Walk to where the last enemy cannot see you.", TakeCover, take_cover)
RELOAD = Tool("reload", "Reload the weapon; an empty clip is reloaded without it.", NoArguments, reload)
HOLD_FIRE = Tool("hold_fire", "Shoot at nobody until you attack.", NoArguments, hold_fire)
