"""The Wildscav engine: maps, motion, combat, sensors, tracks, robots, records and replays."""

import sys

from wildscav_engine.version import ENGINE_VERSION, SIMULATION_VERSION

__all__ = ["ENGINE_VERSION", "SIMULATION_VERSION"]

# ``gymnasium.make("wildscav_engine:WildScav/Navigation-v0")`` imports this package, then expects the ids.
# Where nobody has imported Gymnasium or PettingZoo, as in match servers, nothing needs the ids.
if sys.modules.get("gymnasium") or sys.modules.get("pettingzoo"):
    import wildscav_engine.envs  # noqa: F401
