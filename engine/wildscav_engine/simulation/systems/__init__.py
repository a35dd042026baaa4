"""The systems of the game: weapons, damage, supplies, the safe zone, and what ends a match."""
