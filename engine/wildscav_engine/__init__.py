"""The Wildscav engine: maps, motion, combat, sensors, tracks, robots, records and replays."""

# Registers the ids of the environments, whatever is imported first. Gymnasium imports this package to find
# ``wildscav_engine:WildScav/Navigation-v1``, but only if nobody else has. Gymnasium itself takes 0.15 s.
import wildscav_engine.envs  # noqa: F401
from wildscav_engine.version import ENGINE_VERSION, SIMULATION_VERSION

__all__ = ["ENGINE_VERSION", "SIMULATION_VERSION"]
