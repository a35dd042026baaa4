"""The Wildscav engine: maps, motion, combat, sensors, tracks, robots, records and replays."""

from importlib.metadata import version

ENGINE_VERSION = version("wildscav")

__all__ = ["ENGINE_VERSION"]
