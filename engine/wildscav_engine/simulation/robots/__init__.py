"""Built-in opponents that play inside the engine: one file and one line in ``decide.py`` a robot."""

from wildscav_engine.simulation.robots.base import Robot
from wildscav_engine.simulation.robots.decide import ROBOTS

__all__ = ["ROBOTS", "Robot"]
