"""The behaviour that robots share: turning, walking, and getting free when they are stuck.

A robot is a kernel that reads what its seat may know and writes one action row. It draws random numbers from
the match's seed and keeps a few numbers in ``Agents.memory``.

Records name robots. The number of a robot of another package follows from the name of its kind alone, so that
it does not depend on what else is installed.
"""

from collections.abc import Callable
from enum import IntEnum
from hashlib import blake2b
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import arctangent, wrap
from wildscav_engine.arithmetic.random_numbers import Stream, uniform_in
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.world import World
from wildscav_engine.simulation.robots.skill import LEVELS, Skill
from wildscav_engine.simulation.state import Agents, Matches, Supplies
from wildscav_engine.simulation.systems.hot_spot import hot_spot_at
from wildscav_engine.simulation.systems.visibility import Seen
from wildscav_engine.simulation.systems.zone import zone_at
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.rules import FRAME

STUCK_SPEED = 0.3  # of the wanted speed; a slower robot is stuck
PATIENCE = 3.0  # steps for which it is stuck before it tries a detour
DETOUR = 6.0  # m, length of a detour
FIRST_ADDED, ADDED_KINDS = 100, 100_000_000  # the numbers of kinds that other packages add
HOT_SPOT_LEAD = 500  # frames before the hot spot moves at which a robot sets off for its next place
HOT_SPOT_NEAR = 8.0  # m from the place of the hot spot within which a robot looks around
SAFE_MARGIN = 5.0  # m inside the edge of the safe zone that a robot keeps


class Memory(IntEnum):
    """The indices of the numbers in a robot's memory."""

    HEADING = 0  # degrees, direction in which it wanders
    WANDER_LEFT = 1  # steps until it chooses another heading
    WANTED_SPEED = 2  # m/s of its last action
    STUCK = 3  # consecutive steps without progress
    DETOUR_LEFT = 4  # steps left on a detour
    DETOUR_HEADING = 5  # degrees
    FETCHING = 6  # steps since it last got a box or gave one up
    DISTRACTED_LEFT = 7  # steps for which it still ignores boxes
    NEAREST = 8  # m, the least distance to the target since it last got past an obstacle, 0 for none
    DETOURS = 9  # around the current obstacle
    DETOUR_SIDE = 10  # degrees between its detour and the straight way
    HIDE_LEFT = 11  # steps for which it still hides


class Situation(NamedTuple):
    """What a robot knows when it decides: the slices of its match and its own seat."""

    agents: Agents
    supplies: Supplies
    seen: Seen
    seat: int
    seed: int
    frame: int
    frames_per_action: int
    matches: Matches
    match: int
    skill: Skill
    world: World
    spread: float  # degrees, of its shots when it stands still
    walking_sway: float  # how many times more when it walks at full speed


Act = Callable[[Situation, NDArray[np.float32]], None]


class Robot(NamedTuple):
    """An opponent that plays inside the engine."""

    name: str
    title: str
    number: int  # in Agents.robot: tens for the kind, ones for the level
    act: Act  # a kernel that writes what the robot does in the coming step into a row of zeros


def levels_of(name: str, title: str, act: Act, kind: int | None = None) -> tuple[Robot, ...]:
    """Return the three levels of a kind of robot; the normal level has the plain name.

    The number of one of ours is given; that of others follows from the name.
    """
    tens = kind_number(name) if kind is None else kind
    return tuple(
        Robot(name if level == "normal" else f"{name}-{level}", title, 10 * tens + number, act)
        for number, level in enumerate(LEVELS)
    )


def kind_number(name: str) -> int:
    """Return the number of a kind of robot that another package adds."""
    digest = blake2b(name.encode(), digest_size=8).digest()
    return FIRST_ADDED + int.from_bytes(digest, "little") % ADDED_KINDS


def check_robots(name: str, levels: Any) -> tuple[Robot, ...]:
    """Return the levels of a kind of robot as an entry point names them; ValueError if they are none."""
    if not isinstance(levels, tuple) or not levels or not all(isinstance(one, Robot) for one in levels):
        raise ValueError("it is not what levels_of returns, a tuple of robots")
    if [robot.name for robot in levels] != [robot.name for robot in levels_of(name, "", levels[0].act)]:
        raise ValueError(f"its levels are called {', '.join(robot.name for robot in levels)}")
    return levels


@kernel
def random_in(now: Situation, low: float, high: float, draw: int) -> float:
    """Return a random number in [low, high) for this robot, frame and draw."""
    return uniform_in(low, high, now.seed, Stream.ROBOT, now.frame, now.seat, draw)


@kernel
def turn_toward(now: Situation, yaw: float, pitch: float, limit: float, action: NDArray[np.float32]) -> None:
    """Turn the view towards a direction by at most ``limit`` degrees in this step."""
    turn = wrap(yaw - now.agents.yaw[now.seat])
    look = pitch - now.agents.pitch[now.seat]
    action[Field.TURN] = min(limit, max(-limit, turn)) / now.frames_per_action
    action[Field.LOOK] = min(limit, max(-limit, look)) / now.frames_per_action


@kernel
def walk_toward(now: Situation, heading: float, speed: float, action: NDArray[np.float32]) -> None:
    """Walk in a direction. When stuck, jump first and then try a detour."""
    memory = now.agents.memory[now.seat]
    velocity = now.agents.velocity[now.seat]
    pace = np.sqrt(velocity[0] * velocity[0] + velocity[2] * velocity[2])
    if pace < STUCK_SPEED * memory[Memory.WANTED_SPEED]:
        memory[Memory.STUCK] += 1.0
        action[Field.JUMP] = 1.0
    else:
        memory[Memory.STUCK] = 0.0
    if memory[Memory.STUCK] > PATIENCE:
        memory[Memory.STUCK] = 0.0
        step_time = now.frames_per_action * FRAME
        memory[Memory.DETOUR_LEFT] = max(1.0, DETOUR / (max(speed, 1.0) * step_time))
        memory[Memory.DETOUR_HEADING] = heading + random_in(now, 60.0, 300.0, 1)
    if memory[Memory.DETOUR_LEFT] > 0.0:
        memory[Memory.DETOUR_LEFT] -= 1.0
        heading = memory[Memory.DETOUR_HEADING]
    memory[Memory.WANTED_SPEED] = speed
    action[Field.WALK_DIRECTION] = wrap(heading)
    action[Field.WALK_SPEED] = speed


@kernel
def wander(now: Situation, action: NDArray[np.float32]) -> None:
    """Walk in random directions, each for a while, looking ahead."""
    memory = now.agents.memory[now.seat]
    memory[Memory.WANDER_LEFT] -= 1.0
    if memory[Memory.WANDER_LEFT] <= 0.0 or memory[Memory.STUCK] > PATIENCE - 1.0:
        memory[Memory.WANDER_LEFT] = random_in(now, 20.0, 80.0, 2)
        memory[Memory.HEADING] = random_in(now, 0.0, 360.0, 3)
    heading = memory[Memory.HEADING]
    walk_toward(now, heading, now.skill.wander_speed, action)
    turn_toward(now, heading, 0.0, now.skill.turn_limit, action)


@kernel
def gather(now: Situation, action: NDArray[np.float32]) -> bool:
    """Walk to the nearest box and pick it up; return False if there is none or it seems out of reach."""
    action[Field.PICK_UP] = 1.0
    if now.seen.supply_count[now.seat] == 0 or gives_up(now):
        return False
    box = now.supplies.position[now.seen.supplies[now.seat, 0]]
    go_to(now, box[0], box[2], action)
    return True


@kernel
def visit_hot_spot(now: Situation, action: NDArray[np.float32]) -> bool:
    """Walk to where the hot spot is or will soon be; return False if there is none or the robot is there."""
    place = hot_spot_at(now.matches, now.match, now.frame + HOT_SPOT_LEAD)
    return place.number >= 0 and _go_unless_near(now, place.x, place.z, HOT_SPOT_NEAR, action)


@kernel
def keep_safe(now: Situation, action: NDArray[np.float32]) -> bool:
    """Walk to the center of the safe zone; return False if the robot is well inside it."""
    zone = zone_at(now.matches, now.match, now.frame)
    return zone.damage != 0.0 and _go_unless_near(now, zone.x, zone.z, zone.radius - SAFE_MARGIN, action)


@kernel
def _go_unless_near(now: Situation, x: float, z: float, near: float, action: NDArray[np.float32]) -> bool:
    """Walk to a position; return False if it is nearer than so many m."""
    here = now.agents.position[now.seat]
    dx, dz = x - here[0], z - here[2]
    if np.sqrt(dx * dx + dz * dz) < near:
        return False
    go_to(now, x, z, action)
    return True


@kernel
def go_to(now: Situation, x: float, z: float, action: NDArray[np.float32]) -> None:
    """Walk to a position, looking ahead."""
    here = now.agents.position[now.seat]
    heading = arctangent(x - here[0], z - here[2])
    walk_toward(now, heading, now.skill.speed, action)
    turn_toward(now, heading, 0.0, now.skill.turn_limit, action)


@kernel
def gives_up(now: Situation) -> bool:
    """Return whether to ignore the boxes in sight, because the nearest one may be out of reach."""
    memory = now.agents.memory[now.seat]
    if memory[Memory.DISTRACTED_LEFT] > 0.0:
        memory[Memory.DISTRACTED_LEFT] -= 1.0
        return True
    memory[Memory.FETCHING] += 1.0
    if now.agents.gained[now.seat] > 0:
        memory[Memory.FETCHING] = 0.0
    elif memory[Memory.FETCHING] > now.skill.patience:
        memory[Memory.FETCHING] = 0.0
        memory[Memory.DISTRACTED_LEFT] = random_in(now, 20.0, 80.0, 6)
    return False
