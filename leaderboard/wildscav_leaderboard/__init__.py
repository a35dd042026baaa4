"""The leaderboard: a database of evaluations, and the standings computed from it."""
