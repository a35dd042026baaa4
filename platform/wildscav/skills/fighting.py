"""Fighting: when to reload, which fights to leave, how to move under fire, and where cover is."""

import math
from collections.abc import Sequence
from itertools import product

from wildscav.agent import Action, MatchInfo, Observation, Vector, VisibleAgent
from wildscav.geometry import (
    BODY_HEIGHT,
    BODY_RADIUS,
    EYE_HEIGHT,
    direction_to,
    flat_distance,
    moved,
    turn_to,
)
from wildscav.skills.aiming import Aim
from wildscav.skills.surroundings import Surroundings
from wildscav.skills.walking import FULL_SPEED, Walk

LOW_CLIP = 0.6  # of the clip: below this it is reloaded, if nobody is in sight
WEAK = 0.4  # of the start's health: at or below it, the weaker one leaves
OUTNUMBERED = 3  # enemies in sight and near, from which on a fight is left
NEAR = 25.0  # m
LOSS = 0.5  # of the supplies at a death, at least
GAIN = 1.0  # supplies per second of gathering, about
SOON = 30.0  # s before a wave, at which its place is avoided
UNDER_FIRE = 1.0  # s after a hit
SIDESTEP = 1.4  # s, until the direction of dodging changes
COVER_STEPS = (3.0, 6.0, 9.0)  # m to the places that are considered
COVER_TURN = 30.0  # degrees between their directions
ALONG = 0.5  # of the speed, at most, along the line of fire while weaving
BACK = 0.6  # of the way across, by which a step back is shorter if the goal is across the line of fire
STEADY = 1.0  # half widths of an enemy over which shots at it may be spread
CREEP = 1.0  # m/s, the slowest walk while shooting
PROBE = 0.5  # m between the points of a line of sight that are checked


def wants_reload(observation: Observation, clip_size: int, in_sight: bool) -> bool:
    """Return whether to reload: an empty clip at once, a low one while no enemy is in sight."""
    if observation.reloading or observation.spare_ammo == 0:
        return False
    return observation.clip == 0 or (not in_sight and observation.clip < clip_size * LOW_CLIP)


def fighting_action(
    observation: Observation, match: MatchInfo, walk: Walk, aim: Aim, in_sight: bool
) -> Action:
    """Return the action of an agent that walks and aims; it picks up what is in reach and reloads in time."""
    return Action(
        walk_direction=walk.direction,
        walk_speed=walk.speed,
        jump=walk.jump,
        turn=aim.turn,
        look=aim.look,
        shoot=aim.shoot,
        reload=wants_reload(observation, match.clip_size, in_sight),
        pick_up=observation.can_pick_up,
    )


def would_lose(observation: Observation, enemies: Sequence[VisibleAgent], start_health: int) -> bool:
    """Return whether a fight is better left: unarmed, the weaker one and hurt, or against many."""
    if not enemies:
        return False
    if observation.clip == 0 or observation.reloading:
        return True
    near = [enemy for enemy in enemies if flat_distance(observation.position, enemy.position) < NEAR]
    if len(near) >= OUTNUMBERED:
        return True
    # An enemy whose health nobody tells is taken for unhurt.
    return observation.health <= WEAK * start_health and observation.health < (
        enemies[0].health or start_health
    )


def has_much_to_lose(observation: Observation, match: MatchInfo) -> bool:
    """Return whether a weak agent carries more than it could gather in what is left of the match."""
    weak = observation.health <= WEAK * match.start_health
    return weak and observation.supplies * LOSS > GAIN * (match.time_limit - observation.time)


def quiet_place(match: MatchInfo, observation: Observation, enemies: Sequence[Vector]) -> Vector:
    """Return a place near the edge of the map, far from enemies (m) and from where supplies appear."""
    edge, height = match.map_size * 0.45, observation.position[1]
    soon = [wave for wave in match.supply_waves if wave.time <= observation.time + SOON][-2:]
    shunned = [*enemies, *((wave.center[0], height, wave.center[1]) for wave in soon)]
    places = [(x, height, z) for x, z in product((-edge, 0.0, edge), repeat=2) if x or z]
    return max(
        places,
        key=lambda place: (
            min((flat_distance(place, other) for other in shunned), default=0.0)
            - 0.5 * flat_distance(place, observation.position)
        ),
    )


def steady(match: MatchInfo, observation: Observation, enemy: VisibleAgent, walk: Walk) -> Walk:
    """Return a walk no faster than lets shots at an enemy fall on its body, where walking spreads them."""
    if match.spread * match.walking_sway == 0.0:
        return walk
    way = max(flat_distance(observation.position, enemy.position), 0.1)
    half_width = math.degrees(math.atan2(BODY_RADIUS, way))
    sway = (STEADY * half_width / match.spread - 1.0) / match.walking_sway
    return walk._replace(speed=min(walk.speed, max(CREEP, FULL_SPEED * sway)))


class Dodging:
    """Remembers hits, and walks across the enemy's line of fire, which is hardest to hit."""

    def __init__(self, match: MatchInfo) -> None:
        self.step_time = match.step_time
        self.side = 1.0 if match.seed % 2 else -1.0
        self.hit_at = -100.0  # s, the last hit
        self.turned_at = 0.0  # s
        self.last: Vector | None = None

    def look(self, observation: Observation) -> None:
        """Take in an observation; call it in every step."""
        if observation.hit_by_seat is not None:
            self.hit_at = observation.time
        blocked = (
            self.last is not None and flat_distance(self.last, observation.position) < 2.0 * self.step_time
        )
        if observation.time - self.turned_at > (0.3 if blocked else SIDESTEP):
            self.side, self.turned_at = -self.side, observation.time
        self.last = observation.position

    def is_under_fire(self, observation: Observation) -> bool:
        """Return whether the agent was hit a moment ago."""
        return observation.time - self.hit_at < UNDER_FIRE

    def direction(self, observation: Observation, enemy: Vector, closing: float = 0.0) -> float:
        """Return the compass direction, degrees, to dodge an enemy; ``closing`` degrees lead nearer to it."""
        return (direction_to(observation.position, enemy) + self.side * (90.0 - closing)) % 360.0


def weave(observation: Observation, enemy: Vector, direction: float) -> Walk:
    """Return how to walk on under fire: across the line of fire, to the other side in every step.

    An enemy that leads its target by the velocity in its observation aims where the agent will not be.

    Args:
        direction: Where the agent would go, degrees. It gets there at up to half of its speed.
    """
    fire = direction_to(observation.position, enemy)
    off = math.radians(turn_to(fire, direction))
    along = max(-ALONG, min(ALONG, math.cos(off)))
    across = math.copysign(math.sqrt(1.0 - along * along), math.sin(off))
    if observation.step % 2:
        across *= BACK * abs(math.sin(off)) - 1.0
    turn = math.degrees(math.atan2(across, along))
    return Walk((fire + turn) % 360.0, FULL_SPEED * math.hypot(across, along))


def cover_from(surroundings: Surroundings, here: Vector, enemy: Vector) -> Vector | None:
    """Return the nearest place that can be walked to straight and is hidden from an enemy, or None.

    Among places at one distance, the one that leads most away from the enemy is taken.
    """
    away = direction_to(enemy, here)
    for way in COVER_STEPS:
        for turn in sorted(range(-5, 7), key=abs):
            place = moved(here, away + COVER_TURN * turn, way)
            if _can_walk(surroundings, here, place) and is_hidden(surroundings, place, enemy):
                return place
    return None


def is_hidden(surroundings: Surroundings, place: Vector, enemy: Vector) -> bool:
    """Return whether a surface that was seen hides the middle of a body at a place from an enemy's eyes."""
    chest = (place[0], place[1] + BODY_HEIGHT / 2.0, place[2])
    eyes = (enemy[0], enemy[1] + EYE_HEIGHT, enemy[2])
    return any(surroundings.is_solid(point) for point in _between(chest, eyes)[1:-1])


def _can_walk(surroundings: Surroundings, here: Vector, place: Vector) -> bool:
    return all(surroundings.is_free(point) for point in _between(here, place)[1:])


def _between(a: Vector, b: Vector) -> list[Vector]:
    """Return points of a straight line, ends included."""
    count = max(int(flat_distance(a, b) / PROBE), 1)
    shares = [step / count for step in range(count + 1)]
    return [(a[0] + (b[0] - a[0]) * s, a[1] + (b[1] - a[1]) * s, a[2] + (b[2] - a[2]) * s) for s in shares]
