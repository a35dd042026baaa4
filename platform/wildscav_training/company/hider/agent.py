"""An agent that takes no part: it stays far from everything, and hides from whom it sees."""

from wildscav import Action, Agent, MatchInfo, Observation, Vector
from wildscav.geometry import direction_to, flat_distance, moved
from wildscav.skills.aiming import enemies_in_sight, look_around
from wildscav.skills.fighting import is_hidden, quiet_place
from wildscav.skills.steering import Steering
from wildscav.skills.surroundings import Rings, Surroundings
from wildscav.skills.zone import Caution, safe_zone

FULL_SPEED = 10.0  # m/s
RINGS = Rings(range=40.0, lowest=-20.0, highest=20.0)  # as in the manifest
EARLY = Caution(margin=8.0, pace=4.0, spare=6.0)
MEMORY = 20.0  # s for which it stays hidden from one that it no longer sees
CLOSE = 0.7  # m
REACHES = (0.0, 3.0, 6.0, 9.0, 12.0)  # m to places that may be hidden


class Hider(Agent):
    """Walks to a quiet place, and into cover from whom it sees. It neither gathers nor fights."""

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match."""
        self.match, self.steering = match, Steering(match.seed)
        self.surroundings = Surroundings(match.map_size, RINGS)
        self.place = match.start  # where it hides
        self.enemy: Vector | None = None  # where the nearest one was seen last
        self.enemy_at = -100.0  # s, when

    def act(self, observation: Observation) -> Action:
        """Look around, and go where nobody sees it."""
        if not observation.alive:
            return Action()
        here, frames = observation.position, self.match.frames_per_action
        self.surroundings.see(here, observation.yaw, observation.sensor("lidar"))
        enemies = enemies_in_sight(observation, self.match.team)
        if enemies:
            self.enemy, self.enemy_at = enemies[0].position, observation.time
        self.place = self.hiding_place(observation)
        direction, jump = self.steering.toward(observation, self.place)
        stays, aim = flat_distance(here, self.place) < CLOSE, look_around(observation, frames)
        speed = 0.0 if stays else FULL_SPEED
        return Action(walk_direction=direction, walk_speed=speed, turn=aim.turn, look=aim.look, jump=jump)

    def hiding_place(self, observation: Observation) -> Vector:
        """Return where to go: to the next circle in time, into cover, or far from everything."""
        here, zone = observation.position, safe_zone(observation, EARLY)
        if not zone.is_safe(here):
            return zone.next.center
        quiet = quiet_place(self.match, observation, [self.enemy] if self.enemy else [])
        if self.enemy is not None and observation.time - self.enemy_at < MEMORY:
            places = (moved(here, direction, way) for way in REACHES for direction in range(0, 360, 30))
            return next(
                (place for place in (self.place, *places) if self.is_covered(place, self.enemy)), quiet
            )
        return quiet if zone.is_safe(quiet) else here

    def is_covered(self, place: Vector, enemy: Vector) -> bool:
        """Return whether a place is free, and known walls hide it and what is beside it from an enemy."""
        across = direction_to(enemy, place) + 90.0
        return self.surroundings.is_free(place) and all(
            is_hidden(self.surroundings, moved(place, across, aside), enemy) for aside in (0.0, -1.0, 1.0)
        )
