"""A body that walks by the engine's own motion, to show what can be walked."""

import math

import numpy as np

from wildscav_engine.geometry.world import World
from wildscav_engine.systems.motion import Bodies, move


class Walker:
    """A body that walks from way point to way point."""

    def __init__(self, world: World, x: float, y: float, z: float) -> None:
        self.world = world
        self.position = np.array([[x, y, z]])
        self.rise, self.on_ground = 0.0, True

    def walk_to(self, x: float, z: float, speed: float) -> bool:
        """Walk straight to a place, and return whether it was reached."""
        left = math.hypot(x - self.position[0, 0], z - self.position[0, 2])
        for _ in range(int(left / speed * 50.0 * 2.0) + 50):
            east, north = x - self.position[0, 0], z - self.position[0, 2]
            left = math.hypot(east, north)
            if left < 0.05 and self.on_ground:
                return True
            direction = math.degrees(math.atan2(east, north)) % 360.0
            bodies = Bodies(self.position, np.array([True]), 0)
            moved = move(
                self.world,
                bodies,
                self.rise,
                self.on_ground,
                direction,
                min(speed, left * 50.0),
                False,  # does not jump
                0.5,
            )
            self.position[0] = moved.x, moved.y, moved.z
            self.rise, self.on_ground = moved.rise, moved.on_ground
        return False
