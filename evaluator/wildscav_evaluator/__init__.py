"""Evaluations: seeded suites of matches, played by agents in processes of their own, scored and kept."""
