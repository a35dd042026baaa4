"""An agent that makes a map of what it sees, and takes the shortest way over it."""

import math
import random

from columns import STEP, Columns, DepthCamera, Vector
from planning import Node, find_way, is_free, is_straight

from wildscav import Action, Agent, MatchInfo, Observation
from wildscav.geometry import direction_to, flat_distance, moved, turn_to

FULL_SPEED = 10.0  # m/s
FIELD_OF_VIEW, FAR = 100.0, 40.0  # degrees and m, as in submission.toml
LOOK_DOWN = 12.0  # degrees
GLANCES = (0.0, 70.0, 0.0, -70.0)  # degrees beside the way, where it looks in turn
STUCK_STEPS, STUCK_WAY = 3, 0.4  # an agent that moves less m than this in so many steps is stuck
JUMPS = 3  # steps of jumping, before the place ahead counts as closed
PLAN_AGE = 12  # steps after which a way is planned anew
LOOKED_AT = 500  # places that a search looks at, for which its way is kept a step longer
FORGOTTEN = 3.0  # m around the agent that it forgets if its map leaves it no way
AHEAD = 40  # places of the way among which the farthest is chosen to which nothing is in the way


class Mapper(Agent):
    """Walks to the target along the shortest way over its own map; what it did not see counts as free."""

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match."""
        self.match = match
        self.columns = Columns(match)
        self.camera = DepthCamera(FIELD_OF_VIEW, FAR)
        self.way: list[Node] = []
        self.age = 0  # steps since the way was planned, less for a long search
        self.before = match.start
        self.trail: list[Vector] = []
        self.jumps = 0  # steps of jumping left
        self.tries = 0  # to get on from about the same place
        self.random = random.Random(match.seed)  # noqa: S311 (a game, not a secret)
        self.escape: float | None = None  # a direction, degrees, in which it walks where nothing else helps
        self.aim: tuple[float, float] = (match.start[0], match.start[2])

    def act(self, observation: Observation) -> Action:
        """Look, plan, and walk."""
        here = observation.position
        target = observation.target or here
        points = self.camera.points(observation.depth, here, observation.yaw, observation.pitch)
        self.columns.see(*points)
        if observation.on_ground:
            self.columns.walk(self.before, here)
        self.before = here
        self._notice_obstacle(observation)
        rises = self._choose_aim(here, target)
        direction = direction_to(here, (self.aim[0], here[1], self.aim[1]))
        left = math.hypot(self.aim[0] - here[0], self.aim[1] - here[2])
        speed = min(FULL_SPEED, max(1.0, left / self.match.step_time))
        if self.jumps == 0:
            self.escape = None
        elif self.escape is not None:
            direction, speed = self.escape, FULL_SPEED
        self.jumps = max(0, self.jumps - 1)
        frames = self.match.frames_per_action
        look = direction + GLANCES[observation.step % len(GLANCES)]
        return Action(
            walk_direction=direction,
            walk_speed=speed,
            turn=turn_to(observation.yaw, look) / frames,
            look=(LOOK_DOWN - observation.pitch) / frames,
            jump=rises or self.jumps > 0,
        )

    def _choose_aim(self, here: Vector, target: Vector) -> bool:
        """Choose the place to walk to now; return whether the way there begins with a jump."""
        goal = target[0], target[2]
        if is_straight(self.columns, here, goal, self.columns.level(target[1])):
            self.way, self.aim = [], goal
            return False
        self.age += 1
        at = self._place_on_way(here)
        if at is None or self.age > PLAN_AGE or not is_free(self.columns, self.way[: at + 80], at):
            self.way, looked_at = find_way(self.columns, here, target)
            self.age, at = -looked_at // LOOKED_AT, 0
            if len(self.way) < 2:
                self.columns.forget(here, FORGOTTEN)
                self.age = PLAN_AGE
        return self._follow(here, at)

    def _place_on_way(self, here: Vector) -> int | None:
        """Return the index of the place of the way where the agent is, or None if it left its way."""
        best, best_distance = None, 2.5
        for index, node in enumerate(self.way[:60]):
            x, z = self.columns.place(node.cell)
            distance = math.hypot(x - here[0], z - here[2])
            if distance < best_distance:
                best, best_distance = index, distance
        return best

    def _follow(self, here: Vector, at: int) -> bool:
        """Aim at the farthest place of the way to which nothing is in the way."""
        self.way = self.way[at:]
        ahead = self.way[1 : AHEAD + 1]
        floor = self.columns.level(here[1])
        for node in [*ahead[:0:-3], *ahead[1:3][::-1]]:
            if is_straight(self.columns, here, self.columns.place(node.cell), node.height):
                self.aim = self.columns.roomy_place(node.cell, node.height)
                return False
        if ahead:
            node = ahead[min(1, len(ahead) - 1)]
            self.aim = self.columns.roomy_place(node.cell, node.height)
        return any(node.is_known and node.height > floor + STEP for node in ahead[:3])

    def _notice_obstacle(self, observation: Observation) -> None:
        """Jump where nothing seen explains why there is no way on; then remember the place as closed."""
        here = observation.position
        self.trail = [*self.trail[-STUCK_STEPS:], here]
        slow = STUCK_WAY * (0.5 if observation.in_water else 1.0)
        if len(self.trail) <= STUCK_STEPS or flat_distance(self.trail[0], here) > slow:
            if flat_distance(self.trail[0], here) > 2.0:
                self.tries = 0
            return
        self.trail = []
        self.tries += 1
        if self.tries == 1:
            self.jumps = JUMPS
            return
        direction = direction_to(here, (self.aim[0], here[1], self.aim[1]))
        for distance in (0.5, 0.8):
            for turn in (-30.0, 0.0, 30.0):
                place = moved(here, direction + turn, distance)
                self.columns.bump(place[0], place[2], although_walked=self.tries > 3)
        if self.tries % 4 == 0:
            self.escape, self.jumps = self.random.uniform(0.0, 360.0), JUMPS
        self.age = PLAN_AGE
