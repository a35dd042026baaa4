"""Records of real matches."""

from tests.recorded_matches import record_of_track

__all__ = ["record_of_track"]
