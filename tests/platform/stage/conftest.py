"""Records of real matches, and a small viewer."""

from tests.platform.stage.built_viewer import viewer
from tests.recorded_matches import record_of_track

__all__ = ["record_of_track", "viewer"]
