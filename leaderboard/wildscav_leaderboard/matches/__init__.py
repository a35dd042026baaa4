"""Matches of the season: those that wait, those that are played, and their results."""
