"""Evaluations: seeded suites of matches, played by agents in separate processes, scored and saved."""
