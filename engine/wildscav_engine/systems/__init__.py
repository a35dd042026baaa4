"""The systems of the game: motion, weapons, supplies, respawn."""
