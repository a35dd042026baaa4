"""Aiming: at the nearest enemy, ahead of one that moves, and shooting when the shot will hit."""

import math
from typing import NamedTuple

from wildscav.agent import MatchInfo, Observation, Vector, VisibleAgent
from wildscav.geometry import BODY_HEIGHT, BODY_RADIUS, direction_to, flat_distance, moved, pitch_to, turn_to

MAX_TURN = 36.0  # degrees per frame: half a turn in a step of 5 frames
SCAN_TURN = 9.0  # degrees per frame, to look around
TURN_ROUND = 110.0  # degrees in a step, to find an enemy that was felt and is not in sight
SURE_SHOT = 0.8  # of the body: the largest aiming error for a shot
AIM_HEIGHT = 1.3  # m above the soles: chests are seen over more than middles are
LOOKS_AT = 20.0  # degrees off an agent, within which an enemy may be aiming at it
FRAMES_PER_SECOND = 50
FASTEST = 12.0  # m/s, above the fastest walk: who moved faster has died and respawned
MEMORY = 0.25  # s between two sights of an enemy from which its velocity follows
MISSES = 3  # rounds in a row that one enemy may cost
PAUSE = 3.0  # s without fire at an enemy that was missed so often


class Aim(NamedTuple):
    """How to turn and look during a step, and whether to shoot."""

    turn: float  # degrees per frame
    look: float  # degrees per frame
    shoot: bool = False  # in this step


def enemies_in_sight(observation: Observation, team: int) -> list[VisibleAgent]:
    """Return the enemies in sight that can be hurt, nearest first."""
    return [agent for agent in observation.agents if agent.team != team and not agent.invincible]


class Lookout:
    """Watches the enemies in sight, and estimates their velocities where nobody tells them."""

    def __init__(self, match: MatchInfo) -> None:
        self.team, self.is_told = match.team, match.senses == "original"
        self.last: dict[int, tuple[float, Vector]] = {}  # when and where each was seen, by seat

    def enemies(self, observation: Observation) -> list[VisibleAgent]:
        """Return the enemies in sight that can be hurt, nearest first; call it in every step."""
        enemies = enemies_in_sight(observation, self.team)
        if self.is_told:
            return enemies
        moving = [enemy._replace(velocity=self._velocity(observation.time, enemy)) for enemy in enemies]
        self.last |= {enemy.seat: (observation.time, enemy.position) for enemy in enemies}
        return moving

    def _velocity(self, now: float, enemy: VisibleAgent) -> Vector:
        """Return the mean velocity since an enemy was last seen; none if that was long ago."""
        before, (x, y, z) = self.last.get(enemy.seat, (now, enemy.position))
        passed = now - before
        if not 0.0 < passed <= MEMORY:
            return (0.0, 0.0, 0.0)
        here = enemy.position
        velocity = ((here[0] - x) / passed, (here[1] - y) / passed, (here[2] - z) / passed)
        return velocity if math.hypot(velocity[0], velocity[2]) <= FASTEST else (0.0, 0.0, 0.0)


def threats_first(observation: Observation, enemies: list[VisibleAgent]) -> list[VisibleAgent]:
    """Return enemies by their danger: who has just hit the agent, then who looks at it, then who is near."""

    def harmlessness(enemy: VisibleAgent) -> tuple[bool, bool]:
        off = turn_to(enemy.yaw, direction_to(enemy.position, observation.position))
        return enemy.seat != observation.hit_by_seat, abs(off) > LOOKS_AT

    return sorted(enemies, key=harmlessness)


def aim_at(
    observation: Observation,
    enemy: VisibleAgent,
    own_velocity: Vector,
    frames: int,
    max_turn: float = MAX_TURN,
) -> Aim:
    """Turn to where an enemy will be after this step, in which the agent walks at its own velocity, m/s.

    It shoots if it hits from the first frame to the last. ``max_turn`` is in degrees per frame.
    """
    last = _view_of(observation, enemy, own_velocity, frames)
    turn = _limited(turn_to(observation.yaw, last.direction) / frames, max_turn)
    look = _limited((last.pitch - observation.pitch) / frames, max_turn)
    return Aim(turn, look, will_hit(observation, enemy, own_velocity, frames, turn, look))


def will_hit(
    observation: Observation,
    enemy: VisibleAgent,
    own_velocity: Vector,
    frames: int,
    turn: float,
    look: float,
) -> bool:
    """Return whether an enemy is in the sights in the first and in the last frame of a step.

    Args:
        own_velocity: The velocity at which the agent will walk in this step, m/s.
        turn: The turn of the step, degrees per frame.
        look: How the pitch changes in the step, degrees per frame.
    """
    views = [(frame, _view_of(observation, enemy, own_velocity, frame)) for frame in (1, frames)]
    return all(
        abs(turn_to(observation.yaw + turn * frame, view.direction)) < view.half_width
        and abs(view.pitch - observation.pitch - look * frame) < view.half_height
        for frame, view in views
    )


def look_around(observation: Observation, frames: int) -> Aim:
    """Keep turning with a level view; after a hit by an agent that is not in sight, turn round quickly."""
    turn = SCAN_TURN if observation.hit_by_seat is None else TURN_ROUND / frames
    return Aim(turn, _limited(-observation.pitch / frames))


def velocity_of(direction: float, speed: float) -> Vector:
    """Return the velocity of walking in a compass direction (degrees) at a speed, m/s."""
    return moved((0.0, 0.0, 0.0), direction, speed)


class Thrift:
    """Saves rounds: holds fire for a while at an enemy that several rounds in a row have missed."""

    def __init__(self) -> None:
        self.target: int | None = None  # the seat that was aimed at
        self.misses: dict[int, int] = {}  # in a row, by seat
        self.hold_until: dict[int, float] = {}  # s, by seat

    def look(self, observation: Observation) -> None:
        """Take in whether the last round hit; call it in every step."""
        if not observation.fired or self.target is None:
            return
        hit = observation.hit_seat is not None
        self.misses[self.target] = 0 if hit else self.misses.get(self.target, 0) + 1
        if self.misses[self.target] >= MISSES:
            self.misses[self.target] = 0
            self.hold_until[self.target] = observation.time + PAUSE

    def may_shoot(self, observation: Observation, enemy: VisibleAgent) -> bool:
        """Return whether to shoot at an enemy now; the rounds of this step count as shot at it."""
        self.target = enemy.seat
        return observation.time >= self.hold_until.get(enemy.seat, 0.0)


class _View(NamedTuple):
    """Where an enemy is seen, and how large."""

    direction: float  # degrees, compass
    pitch: float  # degrees, positive downwards
    half_width: float  # degrees
    half_height: float  # degrees


def _view_of(observation: Observation, enemy: VisibleAgent, own_velocity: Vector, frame: int) -> _View:
    seconds = frame / FRAMES_PER_SECOND
    here, there = observation.position, enemy.position
    middle: Vector = (
        there[0] + (enemy.velocity[0] - own_velocity[0]) * seconds,
        there[1] + AIM_HEIGHT,
        there[2] + (enemy.velocity[2] - own_velocity[2]) * seconds,
    )
    way = max(flat_distance(here, middle), 0.1)
    return _View(
        direction_to(here, middle),
        pitch_to(here, middle),
        math.degrees(math.atan2(BODY_RADIUS, way)) * SURE_SHOT,
        math.degrees(math.atan2(BODY_HEIGHT - AIM_HEIGHT, way)) * SURE_SHOT,
    )


def max_turn_of(match: MatchInfo) -> float:
    """Return the fastest useful turn that the rules of a match allow, degrees per frame."""
    return min(MAX_TURN, match.turn_speed / match.frames_per_second)


def _limited(turn: float, max_turn: float = MAX_TURN) -> float:
    return max(-max_turn, min(max_turn, turn))
