"""The kinds of match: one file and one registry line a track."""

from wildscav_engine.tracks.base import Metric, Track
from wildscav_engine.tracks.battle import Battle
from wildscav_engine.tracks.gathering import Gathering
from wildscav_engine.tracks.navigation import Navigation

TRACKS: dict[str, Track] = {
    "navigation": Navigation(),
    "gathering": Gathering(),
    "battle": Battle(),
}

__all__ = ["TRACKS", "Metric", "Track"]
