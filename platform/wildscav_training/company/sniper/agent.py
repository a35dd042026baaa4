"""An agent that shoots from afar: few shots, from a place with a view, out of reach of others."""

from wildscav import Action, Agent, MatchInfo, Observation, Vector
from wildscav.geometry import flat_distance
from wildscav.skills.aiming import FRAMES_PER_SECOND, Lookout, aim_at, look_around, max_turn_of
from wildscav.skills.fighting import fighting_action, quiet_place
from wildscav.skills.searching import Search
from wildscav.skills.steering import Steering
from wildscav.skills.walking import FULL_SPEED, Walk
from wildscav.skills.zone import safe_zone

SCOUTING = 10.0  # s for which it looks for a place with a view
NEAR = 20.0  # m, within which it runs from an enemy
MEMORY = 3.0  # s for which it minds one that it no longer sees
AT_POST = 1.0  # m
PAUSE = 0.8  # s between shots, until recoil has settled
STILL = 0.1  # m/s, above which it does not shoot
CALM = 30.0  # degrees/s, the fastest turn during a shot


class Sniper(Agent):
    """Stands where it sees far, shoots slowly and exactly, and runs from whoever comes near."""

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match."""
        self.match = match
        self.lookout, self.steering, self.search = Lookout(match), Steering(match.seed), Search(match)
        self.post, self.view = match.start, 0.0  # the place with the widest view so far, and its mean in m
        self.enemy: Vector | None = None  # where the nearest one was seen last
        self.enemy_at = self.shot_at = -100.0  # s, when it was seen, and when a shot was fired

    def act(self, observation: Observation) -> Action:
        """Walk, turn to the nearest enemy, and shoot if that hits: who walks or turns misses from afar."""
        if not observation.alive:
            return Action()
        enemies = self.lookout.enemies(observation)
        if enemies:
            self.enemy, self.enemy_at = enemies[0].position, observation.time
        goal, frames = self.goal(observation), self.match.frames_per_action
        walk, aim = Walk(0.0, 0.0), look_around(observation, frames)
        if flat_distance(observation.position, goal) > AT_POST:
            direction, jump = self.steering.toward(observation, goal)
            walk = Walk(direction, FULL_SPEED, jump)
        if enemies:
            aim = aim_at(observation, enemies[0], (0.0, 0.0, 0.0), frames, max_turn_of(self.match))
            east, _, north = observation.velocity
            is_still = walk.speed == 0.0 and abs(east) + abs(north) < STILL
            is_calm = abs(aim.turn) * FRAMES_PER_SECOND < CALM and observation.time - self.shot_at >= PAUSE
            aim = aim._replace(shoot=aim.shoot and is_still and is_calm)
            self.shot_at = observation.time if aim.shoot else self.shot_at
        return fighting_action(observation, self.match, walk, aim, bool(enemies))

    def goal(self, observation: Observation) -> Vector:
        """Return where to go: into the safe zone, away from an enemy, to look for a view, or to its post."""
        here, zone = observation.position, safe_zone(observation)
        if not zone.is_safe(here):
            self.view = 0.0  # the post is lost
            return zone.next.center
        view = float(observation.sensor("lidar").mean())
        if view > self.view:
            self.post, self.view = here, view
        if self.enemy is not None and observation.time - self.enemy_at < MEMORY:
            is_near = flat_distance(here, self.enemy) < NEAR
            return quiet_place(self.match, observation, [self.enemy]) if is_near else here
        return self.search.next_place(observation) if observation.time < SCOUTING else self.post
