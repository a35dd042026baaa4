"""The kinds of match, one file each. ``extensions.py`` lists them."""

from wildscav_engine.simulation.track import TRACKS, Metric, Track

__all__ = ["TRACKS", "Metric", "Track"]
