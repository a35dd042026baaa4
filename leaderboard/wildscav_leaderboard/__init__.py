"""The leaderboard: evaluations in a database, and the standings that follow from them."""
