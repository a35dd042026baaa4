"""Matches: who sits where, their agents' processes, and the workers that play one after another."""
