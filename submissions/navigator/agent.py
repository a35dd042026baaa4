"""The policy that won the competition's navigation, as the paper tells it."""

import math
import random
from collections import deque

from memory import Memory, Vector
from sight import HEADINGS, Sight

from wildscav import Action, Agent, MatchInfo, Observation
from wildscav.geometry import direction_to, flat_distance, moved, turn_to

FULL_SPEED = 10.0  # m/s
LOOK_DOWN = 10.0  # degrees
NEAR = 2.5  # m; a way that is free less far is blocked
PATIENCE = 6  # steps over which the agent's progress is measured
STUCK_WAY = 1.2  # m, an agent that moves less than this in so many steps is stuck
JUMPS = 5  # steps of jumping
RETURN_STEPS = 25  # to get back to a checkpoint, at most
DETOUR_STEPS = 12  # steps for which it keeps to one side after it returned, more each time
LONG = 50  # steps without progress after which it returns, even if it moves
MARKED = 12.0  # degrees that a mark near a heading is worth
AWAY = 80.0  # degrees that it turns where all it sees is blocked
PROGRESS = 5.0  # m nearer to the target than before: the obstacle has been passed
WIDEST = 150.0  # degrees from the target's direction that it turns away, at most


class Navigator(Agent):
    """Walks towards the target where it sees a free way, and goes back to a checkpoint when stuck."""

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match."""
        self.match = match
        self.sight, self.memory = Sight(), Memory(match.start)
        self.trail: deque[Vector] = deque(maxlen=PATIENCE)
        self.random = random.Random(match.seed)  # noqa: S311 (a game, not a secret)
        self.way_back: list[Vector] = []  # the checkpoints that it returns to, one after the other
        self.steps_in_vain = 0  # since it was nearer to the target than before
        self.return_left = self.detour_left = self.jumps_left = 0  # steps
        self.side = self.random.choice((-1.0, 1.0))  # to which it goes around obstacles
        self.failures = 0  # to get on, since it was last nearer to the target than before
        self.nearest = math.inf  # m, to the target
        self.jumped_at: Vector | None = None

    def act(self, observation: Observation) -> Action:
        """Walk to the target, or back to a checkpoint."""
        here, target = observation.position, observation.target or observation.position
        self.memory.note(here)
        if flat_distance(here, target) < self.nearest - PROGRESS:
            self.nearest, self.failures, self.steps_in_vain = flat_distance(here, target), 0, 0
        free = self.sight.free_ways(observation.depth, observation.pitch)
        direction = self._direction(observation, target, free)
        if self._is_stuck(observation):
            self._get_unstuck(observation, direction, free)
        elif self.steps_in_vain > LONG:
            self._return(here)
        self.jumps_left = max(0, self.jumps_left - 1)
        frames = self.match.frames_per_action
        return Action(
            walk_direction=direction,
            walk_speed=min(FULL_SPEED, max(1.0, flat_distance(here, target) / self.match.step_time)),
            turn=turn_to(observation.yaw, direction) / frames,
            look=(LOOK_DOWN - observation.pitch) / frames,
            jump=self.jumps_left > 0,
        )

    def _direction(self, observation: Observation, target: Vector, free: dict[float, float]) -> float:
        """Return the compass direction to walk in, degrees."""
        here = observation.position
        while self.way_back:
            self.return_left -= 1
            if self.return_left > 0 and flat_distance(here, self.way_back[0]) > 1.0:
                return direction_to(here, self.way_back[0])
            self.way_back.pop(0)
            self.return_left, self.detour_left = RETURN_STEPS, DETOUR_STEPS * self.failures
        self.steps_in_vain += self.detour_left == 0
        wanted = direction_to(here, target)
        if self.detour_left > 0:
            self.detour_left -= 1
            wanted += self.side * min(60.0 + 15.0 * self.failures, WIDEST)
        if max(free.values()) < min(NEAR, flat_distance(here, target)):
            return observation.yaw + self.side * AWAY  # it sees nothing but obstacles
        ways = {observation.yaw + heading: far for heading, far in free.items()}
        near = flat_distance(here, target)
        return min(ways, key=lambda way: self._cost(here, way, wanted, ways[way], near))

    def _cost(self, here: Vector, way: float, wanted: float, free: float, near: float) -> float:
        """Return how bad a direction is, degrees."""
        blocked = max(0.0, min(NEAR, near) - free) * 90.0
        marks = self.memory.marked(moved(here, way, 2.0)) if self.failures else 0
        return abs(turn_to(wanted, way)) + blocked + MARKED * marks

    def _is_stuck(self, observation: Observation) -> bool:
        self.trail.append(observation.position)
        slow = STUCK_WAY * (0.5 if observation.in_water else 1.0)
        return len(self.trail) == PATIENCE and flat_distance(self.trail[0], observation.position) < slow

    def _get_unstuck(self, observation: Observation, direction: float, free: dict[float, float]) -> None:
        """Jump if nothing is to be seen ahead, else return to the last checkpoint."""
        self.trail.clear()
        here = observation.position
        heading = min(HEADINGS, key=lambda one: abs(turn_to(observation.yaw + one, direction)))
        has_jumped = self.jumped_at is not None and flat_distance(self.jumped_at, here) < STUCK_WAY
        if free[heading] >= NEAR and not has_jumped:
            self.jumps_left, self.jumped_at = JUMPS, here
            return
        self.memory.mark(moved(here, direction, 1.0))
        self._return(here)

    def _return(self, here: Vector) -> None:
        """Turn back to a checkpoint, to an earlier one each time, and then keep to one side."""
        self.failures += 1
        if self.failures % 3 == 0:
            self.side = -self.side
        self.steps_in_vain = 0
        self.way_back = self.memory.way_back(here, 1 + 2 * (self.failures - 1))
        self.return_left = RETURN_STEPS
