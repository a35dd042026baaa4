"""Matches: their jobs, the processes of their agents, and the workers that play them."""
