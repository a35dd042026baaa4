"""The kinds of match: one file and one registry line a track."""

from wildscav_engine.specs.track import Metric, Track
from wildscav_engine.tracks.battle import Battle
from wildscav_engine.tracks.capture import Capture
from wildscav_engine.tracks.gathering import Gathering
from wildscav_engine.tracks.navigation import Navigation
from wildscav_engine.tracks.royale import Royale

TRACKS: dict[str, Track] = {
    "navigation": Navigation(),
    "gathering": Gathering(),
    "capture": Capture(),
    "battle": Battle(),
    "royale": Royale(),
}

__all__ = ["TRACKS", "Metric", "Track"]
