"""An agent that gathers, and fights the enemies that it meets."""

from wildscav import Action, Agent, MatchInfo, Observation, Vector, VisibleAgent
from wildscav.geometry import direction_to, flat_distance
from wildscav.skills.aiming import Aim, Lookout, aim_at, look_around, max_turn_of, velocity_of
from wildscav.skills.fighting import (
    Dodging,
    cover_from,
    fighting_action,
    has_much_to_lose,
    quiet_place,
    steady,
    would_lose,
)
from wildscav.skills.gathering import Gathering
from wildscav.skills.walking import FULL_SPEED, Walk
from wildscav.skills.zone import safe_zone

FIGHT_RANGE = 22.0  # m, within which an enemy is dodged rather than ignored
AT_PLACE = 4.0  # m
PLAN_EVERY = 50  # steps between choices of a quiet place
FAR = 12.0  # m, beyond which it comes nearer while it dodges


class Commando(Agent):
    """Gathers like ``scavenger``, shoots at the nearest enemy, and leaves fights that it would lose."""

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match."""
        self.match = match
        self.is_armed = match.track != "gathering"  # where nobody shoots, it only gathers
        self.gathering = Gathering(match)
        self.dodging, self.lookout = Dodging(match), Lookout(match)
        self.met: list[Vector] = []  # where enemies were, lately
        self.quiet: Vector | None = None  # where it lies low

    def act(self, observation: Observation) -> Action:
        """Decide where to walk, then aim from there."""
        self.gathering.look(observation)
        if not observation.alive:
            return Action()
        self.dodging.look(observation)
        enemies = self.lookout.enemies(observation) if self.is_armed else []
        walk = self.walk(observation, enemies)
        if enemies:
            walk = steady(self.match, observation, enemies[0], walk)
        aim = self.aim(observation, enemies, walk)
        return fighting_action(observation, self.match, walk, aim, bool(enemies))

    def walk(self, observation: Observation, enemies: list[VisibleAgent]) -> Walk:
        """Return how to walk: out of a fight that would be lost, across the line of fire, or to supplies."""
        zone = safe_zone(observation)
        careful = self.is_armed and has_much_to_lose(observation, self.match)
        if enemies and zone.is_safe(observation.position):
            self.met = [*self.met[-4:], enemies[0].position]
            if careful or would_lose(observation, enemies, self.match.start_health):
                return self.retreat(observation, enemies[0])
            if self.fights(observation, enemies[0]):
                nearest = enemies[0].position
                closing = 35.0 if flat_distance(observation.position, nearest) > FAR else 0.0
                return Walk(self.dodging.direction(observation, nearest, closing), FULL_SPEED)
        if careful and self.match.respawns:
            return self.lie_low(observation)
        return self.gathering.walk(observation)

    def lie_low(self, observation: Observation) -> Walk:
        """Return how to walk to a quiet place, and wait there."""
        if observation.step % PLAN_EVERY == 0 or self.quiet is None:
            self.quiet = quiet_place(self.match, observation, self.met)
        if flat_distance(observation.position, self.quiet) < AT_PLACE:
            return Walk(0.0, 0.0)
        return self.gathering.go(observation, self.quiet)

    def fights(self, observation: Observation, enemy: VisibleAgent) -> bool:
        """Return whether to fight an enemy rather than to gather while shooting at it."""
        near = flat_distance(observation.position, enemy.position) < FIGHT_RANGE
        return near and self.dodging.is_under_fire(observation)

    def retreat(self, observation: Observation, enemy: VisibleAgent) -> Walk:
        """Return how to walk into cover, or else across the line of fire and away."""
        here = observation.position
        cover = cover_from(self.gathering.surroundings, here, enemy.position)
        if cover is not None:
            return Walk(direction_to(here, cover), FULL_SPEED)
        return Walk(self.dodging.direction(observation, enemy.position, closing=-30.0), FULL_SPEED)

    def aim(self, observation: Observation, enemies: list[VisibleAgent], walk: Walk) -> Aim:
        """Return how to turn: to the nearest enemy, or all around."""
        frames = self.match.frames_per_action
        if not enemies:
            return look_around(observation, frames)
        own = velocity_of(walk.direction, walk.speed)
        return aim_at(observation, enemies[0], own, frames, max_turn_of(self.match))
