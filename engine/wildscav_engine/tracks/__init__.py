"""The tracks, one file for each. ``extensions.py`` lists them."""

from wildscav_engine.simulation.track import MEASURES, TRACKS, Measure, Metric, Track, metrics_of

__all__ = ["MEASURES", "TRACKS", "Measure", "Metric", "Track", "metrics_of"]
