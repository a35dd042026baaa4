"""The commands of the leaderboard and of the season."""
