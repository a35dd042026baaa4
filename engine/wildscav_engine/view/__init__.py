"""Replays of records in Rerun. Only this package imports Rerun, and only when a replay is rendered."""

from wildscav_engine.view.replay import ViewError, rendered, write_replay

__all__ = ["ViewError", "rendered", "write_replay"]
