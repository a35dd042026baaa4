"""The Wildscav engine: maps, motion, combat, sensors, tracks, robots, records and replays."""

from importlib.metadata import version

from wildscav_engine.envs.registry import register

ENGINE_VERSION = version("wildscav")

# Rises whenever the same spec and actions give another match: a record can be played again by its own only.
SIMULATION_VERSION = 4

__all__ = ["ENGINE_VERSION", "SIMULATION_VERSION"]

# ``gymnasium.make("wildscav_engine:WildScav/Navigation-v0")`` imports this module, then expects the ids.
register()
