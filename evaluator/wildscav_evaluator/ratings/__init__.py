"""Ratings of entrants that played against each other: how good each is, and who cannot be told apart."""
