"""Robots: opponents that play inside the engine, one file for each kind. ``extensions.py`` lists them."""
