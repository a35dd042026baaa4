"""Replays: the Rerun scene of a record. Only this package imports Rerun, and only when a replay is made."""

from wildscav_engine.view.replay import ViewError, rendered, write_replay

__all__ = ["ViewError", "rendered", "write_replay"]
