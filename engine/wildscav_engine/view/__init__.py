"""Replays: the Rerun scene of a record."""
