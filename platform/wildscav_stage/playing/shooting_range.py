"""The shooting range: a lawn with targets that stand, walk and strafe at stated distances, and never shoot.

It is a battle by the usual rules, and is recorded like any other. This program plays the seats of the
targets. What they do depends only on the frame and on where they are.
"""

import asyncio
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from enum import StrEnum
from typing import TYPE_CHECKING, NamedTuple

from wildscav.agent import Action, Observation
from wildscav.errors import UserError, describe
from wildscav.sdk.connection import Connection
from wildscav.version import __version__
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.specs.rules import NAMED
from wildscav_engine.specs.supply_config import SupplyConfig

if TYPE_CHECKING:
    from wildscav_server.hosting.hosted_match import HostedMatch

LAWN = MapConfig(size=120, houses=0, relief=0.0, ruggedness=0.0, water=0.0, vegetation=0.0)
SHOOTER = (0.0, 0.0, -40.0)  # m, where the person starts, who looks north
USUAL_TIME = 180.0  # s
FEW_SECONDS = 1.5  # s until a target is back where it started
ENDLESS = 100_000  # rounds
EAST, WEST = 90.0, 270.0  # degrees
FRAMES_OF_A_STEP = 20  # of a target that strafes, until it may turn back
MIX = 0x9E3779B97F4A7C15  # an odd number whose multiples have well mixed upper bits


class Movement(StrEnum):
    """How a target moves, across the person's view."""

    STANDS = "stands"
    WALKS = "walks"
    STRAFES = "strafes"


SPEEDS = {Movement.WALKS: 2.5, Movement.STRAFES: 5.0}  # m/s
WAYS = {Movement.WALKS: 6.0, Movement.STRAFES: 3.0}  # m, to either side


class Target(NamedTuple):
    """What the person shoots at."""

    movement: Movement
    distance: float  # m, to the north of the person
    aside: float  # m, to the east

    @property
    def name(self) -> str:
        """What people read."""
        return f"{self.movement} {self.distance:.0f} m"

    @property
    def start(self) -> tuple[float, float, float]:
        """Where it starts, m."""
        return (self.aside, 0.0, SHOOTER[2] + self.distance)


TARGETS = (
    Target(Movement.STANDS, 10.0, -6.0),
    Target(Movement.WALKS, 15.0, 2.0),
    Target(Movement.STRAFES, 20.0, 9.0),
    Target(Movement.STANDS, 30.0, -9.0),
    Target(Movement.WALKS, 40.0, 1.0),
    Target(Movement.STRAFES, 50.0, -14.0),
    Target(Movement.STANDS, 60.0, 12.0),
)


def range_spec(seed: int, time_limit: float | None, rules: str, frames_per_action: int) -> MatchSpec:
    """Return the spec of a practice at the range; the person has the first seat, targets have the others.

    Raises:
        UserError: There are no such rules.
    """
    if rules not in NAMED:
        raise UserError(f"--rules is {rules!r}; the rules are {', '.join(NAMED)}", exit_code=2)
    own = NAMED[rules]._replace(spare_ammo=ENDLESS, respawn_time=FEW_SECONDS, invincible_time=0.0)
    return MatchSpec(
        track="battle",
        map=MapSpec(config=LAWN, seed=seed),
        seed=seed,
        seats=(SUBMISSION,) * (1 + len(TARGETS)),
        teams=(0, *(1,) * len(TARGETS)),
        starts=(SHOOTER, *(target.start for target in TARGETS)),
        respawn_at="start",
        supplies=SupplyConfig(waves=()),
        time_limit=USUAL_TIME if time_limit is None else time_limit,
        frames_per_action=frames_per_action,
        rules=own,
    )


@asynccontextmanager
async def targets_playing(
    hosted: "HostedMatch", address: str, targets: Mapping[int, Target]
) -> AsyncIterator[None]:
    """Play the seats of targets within the block."""
    for seat, target in targets.items():
        if target.movement == Movement.STANDS:
            hosted.give_up(seat, "a target that stands")  # it is played without actions
    moving = {seat: target for seat, target in targets.items() if target.movement != Movement.STANDS}
    tasks = [asyncio.create_task(_play(hosted, address, seat, target)) for seat, target in moving.items()]
    try:
        yield
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def _play(hosted: "HostedMatch", address: str, seat: int, target: Target) -> None:
    """Play a target that moves, to the end of the match."""
    try:
        async with Connection(address, hosted.tokens[seat], __version__) as connection:
            observation, heading = await connection.first(), EAST
            while observation is not None:
                heading = next_heading(target, observation, heading)
                action = Action(walk_direction=heading, walk_speed=SPEEDS[target.movement])
                observation = await connection.answer(observation.step, action)
    except Exception as error:
        hosted.give_up(seat, describe(error))  # so that nobody waits for it
        raise


def next_heading(target: Target, now: Observation, heading: float) -> float:
    """Return where a target walks next: at the end of its way back, and before that as its movement is."""
    off = now.position[0] - target.aside
    if abs(off) > WAYS[target.movement]:
        return WEST if off > 0 else EAST
    if target.movement == Movement.WALKS or now.frame % FRAMES_OF_A_STEP:
        return heading
    place = (now.frame // FRAMES_OF_A_STEP + round(1000 * target.distance)) * MIX % 2**64
    return EAST if place >> 63 else WEST
