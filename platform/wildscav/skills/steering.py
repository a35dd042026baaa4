"""Walking to a goal without sensors: straight, then jumping, then around what is in the way."""

import math
import random
from collections import deque

from wildscav.agent import Observation, Vector
from wildscav.geometry import direction_to, flat_distance

PATIENCE = 6  # steps over which the agent's progress is measured
STUCK_WAY = 1.2  # m, an agent that moves less than this in so many steps is stuck
JUMPS = 4  # steps of jumping before a detour
PROGRESS = 2.0  # m nearer to the goal than before: the obstacle has been passed


class Steering:
    """Walks towards goals: straight, then jumping, then with detours."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)  # noqa: S311 (a game, not a secret)
        self.trail: deque[Vector] = deque(maxlen=PATIENCE)
        self.goal: Vector | None = None
        self.nearest = math.inf  # shortest distance to the goal so far, m
        self.jumps_left = 0
        self.detours = 0  # number of detours around the current obstacle
        self.detour_left = 0  # steps
        self.offset = 0.0  # angle between the detour and the direct line, degrees

    def toward(self, observation: Observation, goal: Vector) -> tuple[float, bool]:
        """Return the compass direction to walk in (degrees), and whether to jump."""
        self._notice_progress(observation.position, goal)
        self._notice_obstacle(observation)
        direction = direction_to(observation.position, goal)
        if self.detour_left > 0:
            self.detour_left -= 1
            # A low step may block the detour, so jump now and then.
            return direction + self.offset, self.detour_left % 8 == 0
        if self.jumps_left > 0:
            self.jumps_left -= 1
            return direction, True
        return direction, False

    def _notice_progress(self, position: Vector, goal: Vector) -> None:
        if self.goal is None or flat_distance(self.goal, goal) > 1.0:
            self.goal, self.nearest = goal, math.inf
            self.detours = self.detour_left = self.jumps_left = 0
        left = flat_distance(position, goal)
        if left < self.nearest - PROGRESS:
            self.nearest, self.detours = left, 0

    def _notice_obstacle(self, observation: Observation) -> None:
        position = observation.position
        self.trail.append(position)
        if len(self.trail) < PATIENCE or flat_distance(self.trail[0], position) > self._slow(observation):
            return
        self.trail.clear()
        if self.detour_left == 0 and self.detours == 0 and self.jumps_left == 0:
            self.jumps_left = JUMPS
            self.detours = 1
            return
        # Follow the obstacle on one side for a while, then try the other side at a larger angle.
        if self.detours == 1:
            self.offset = self.random.choice((-1.0, 1.0)) * 60.0
        elif self.detours % 3 == 0:
            self.offset = -self.offset
        else:
            self.offset = math.copysign(self.random.uniform(70.0, 150.0), self.offset)
        self.detours += 1
        self.jumps_left = 0
        self.detour_left = min(8 + 5 * self.detours, 60)

    @staticmethod
    def _slow(observation: Observation) -> float:
        return STUCK_WAY * (0.5 if observation.in_water else 1.0)
