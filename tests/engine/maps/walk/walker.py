"""A body that walks with the engine's own motion, to test what can be walked."""

import math

import numpy as np

from wildscav_engine.geometry.world import World
from wildscav_engine.maps.walk import Leg, Path
from wildscav_engine.maps.walk.leaps import LEAP_SPEED
from wildscav_engine.motion.body_motion import move
from wildscav_engine.motion.collision import Bodies

FRAMES = 20_000  # a leg takes less, even across a great map
STEP_RISE = 0.25  # m; who is a centimetre off on stairs may stand one step higher or lower


class Walker:
    """A body that walks from way point to way point."""

    def __init__(self, world: World, x: float, y: float, z: float) -> None:
        self.world = world
        self.position = np.array([[x, y, z]])
        self.rise, self.on_ground = 0.0, True

    def follow(self, path: Path, speed: float) -> bool:
        """Follow a path with its jumps, and return whether the end was reached."""
        return all(self._go(leg, speed) for leg in path.legs)

    def _go(self, leg: Leg, speed: float) -> bool:
        jump = leg.jump
        for _ in range(FRAMES):
            east, north = leg.end[0] - self.position[0, 0], leg.end[2] - self.position[0, 2]
            left = math.hypot(east, north)
            if left < 0.01 and self.on_ground and not jump:
                return abs(self.position[0, 1] - leg.end[1]) <= STEP_RISE
            wanted = min(LEAP_SPEED if leg.leap else speed, left * 50.0)
            before = self.position.copy()
            self.move(math.degrees(math.atan2(east, north)) % 360.0, wanted, jump)
            if np.array_equal(before, self.position) and not jump:
                return False
            jump = False
        return False

    def move(self, direction: float, speed: float, jump: bool) -> None:
        """Move for one frame."""
        bodies = Bodies(self.position, np.zeros(0, np.int32), 0)
        moved = move(self.world, bodies, self.rise, self.on_ground, direction, speed, jump, 0.5)
        self.position[0] = moved.x, moved.y, moved.z
        self.rise, self.on_ground = moved.rise, moved.on_ground

    def walk_to(self, x: float, z: float, speed: float) -> bool:
        """Walk straight to a place, and return whether it was reached."""
        left = math.hypot(x - self.position[0, 0], z - self.position[0, 2])
        for _ in range(int(left / speed * 50.0 * 2.0) + 50):
            east, north = x - self.position[0, 0], z - self.position[0, 2]
            left = math.hypot(east, north)
            if left < 0.05 and self.on_ground:
                return True
            direction = math.degrees(math.atan2(east, north)) % 360.0
            self.move(direction, min(speed, left * 50.0), jump=False)
        return False
