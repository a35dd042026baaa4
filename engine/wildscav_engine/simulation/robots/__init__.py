"""Opponents that play inside the engine: one file a kind of robot, listed in ``extensions.py``."""
