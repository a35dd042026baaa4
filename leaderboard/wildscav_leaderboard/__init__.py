"""The leaderboard: the database of local results, and seasons, the competition as a service."""
