"""An agent that outlives the others: early in the next zone, hard to hit, and sparing with its rounds."""

from wildscav import Action, Agent, MatchInfo, Observation, Vector, VisibleAgent
from wildscav.geometry import direction_to, flat_distance
from wildscav.skills.aiming import (
    Aim,
    Lookout,
    Thrift,
    aim_at,
    look_around,
    max_turn_of,
    threats_first,
    velocity_of,
)
from wildscav.skills.fighting import Dodging, cover_from, fighting_action, is_hidden, weave, would_lose
from wildscav.skills.gathering import Gathering
from wildscav.skills.walking import Walk, hold
from wildscav.skills.zone import Caution, SafeZone, safe_zone

EARLY = Caution(margin=10.0, pace=3.0, spare=15.0)
AT_CENTER = 3.0  # m from the middle of the next circle, within which it stands still
COVER_EVERY = 3  # steps between two searches for cover
ALERT = 1.0  # s after it last saw an enemy, for which it moves as if under fire


class Survivor(Agent):
    """Gathers where it is safe, and fights those that it meets so that it is not hit."""

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match."""
        self.match = match
        self.gathering = Gathering(match, EARLY)
        self.dodging, self.lookout = Dodging(match), Lookout(match)
        self.thrift = Thrift()
        self.enemy: Vector | None = None  # where the most dangerous one was seen last
        self.enemy_at = -100.0  # s, when
        self.shelter: Vector | None = None  # cover that it runs to

    def act(self, observation: Observation) -> Action:
        """Decide where to walk, then aim from there."""
        self.gathering.look(observation)
        if not observation.alive:
            return Action()
        self.dodging.look(observation)
        self.thrift.look(observation)
        enemies = threats_first(observation, self.lookout.enemies(observation))
        if enemies:
            self.enemy, self.enemy_at = enemies[0].position, observation.time
        walk = self.walk(observation, enemies)
        aim = self.aim(observation, enemies, walk)
        return fighting_action(observation, self.match, walk, aim, bool(enemies))

    def walk(self, observation: Observation, enemies: list[VisibleAgent]) -> Walk:
        """Return how to walk: on its way, or if an enemy may shoot at it, weaving there or into cover."""
        zone = safe_zone(observation, EARLY)
        if not enemies and self.reloads_in_cover(observation, zone):
            return Walk(0.0, 0.0)
        walk = self.errand(observation, zone)
        is_alert = observation.time - self.enemy_at < ALERT or self.dodging.is_under_fire(observation)
        if not is_alert or self.enemy is None:
            return walk
        cover = self.cover(observation, enemies, zone)
        if cover is not None:
            walk = Walk(direction_to(observation.position, cover), walk.speed)
        return weave(observation, self.enemy, walk.direction)._replace(jump=walk.jump)

    def errand(self, observation: Observation, zone: SafeZone) -> Walk:
        """Return how to walk in peace: to supplies, or into the middle of the next circle to stand there."""
        here, center = observation.position, zone.next.center
        if not zone.is_safe(here) and flat_distance(here, center) < AT_CENTER:
            return hold(here, center, self.match.step_time)
        return self.gathering.walk(observation)

    def cover(self, observation: Observation, enemies: list[VisibleAgent], zone: SafeZone) -> Vector | None:
        """Return a safe place nearby that is hidden from the enemy, if the agent was hit or would lose."""
        wants = self.dodging.is_under_fire(observation) or would_lose(
            observation, enemies, self.match.start_health
        )
        if not wants or self.enemy is None:
            self.shelter = None
        elif observation.step % COVER_EVERY == 0:
            place = cover_from(self.gathering.surroundings, observation.position, self.enemy)
            self.shelter = place if place is not None and zone.is_safe(place) else None
        return self.shelter

    def reloads_in_cover(self, observation: Observation, zone: SafeZone) -> bool:
        """Return whether it is reloading where its last enemy cannot see it."""
        here = observation.position
        return (
            observation.reloading
            and self.enemy is not None
            and zone.is_safe(here)
            and is_hidden(self.gathering.surroundings, here, self.enemy)
        )

    def aim(self, observation: Observation, enemies: list[VisibleAgent], walk: Walk) -> Aim:
        """Return how to turn: to the most dangerous enemy, or all around."""
        frames = self.match.frames_per_action
        if not enemies:
            return look_around(observation, frames)
        own = velocity_of(walk.direction, walk.speed)
        aim = aim_at(observation, enemies[0], own, frames, max_turn_of(self.match))
        return aim._replace(shoot=aim.shoot and self.thrift.may_shoot(observation, enemies[0]))
