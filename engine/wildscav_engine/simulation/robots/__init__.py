"""Built-in opponents that play inside the engine: one file a kind of robot, listed in ``extensions.py``."""

from wildscav_engine.simulation.robots.base import Robot
from wildscav_engine.simulation.robots.decide import ROBOTS

__all__ = ["ROBOTS", "Robot"]
