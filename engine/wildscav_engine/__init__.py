"""The Wildscav engine: maps, motion, combat, sensors, tracks, robots, records and replays."""

from wildscav_engine.envs.registry import register
from wildscav_engine.version import ENGINE_VERSION, SIMULATION_VERSION

__all__ = ["ENGINE_VERSION", "SIMULATION_VERSION"]

# ``gymnasium.make("wildscav_engine:WildScav/Navigation-v0")`` imports this module, then expects the ids.
register()
