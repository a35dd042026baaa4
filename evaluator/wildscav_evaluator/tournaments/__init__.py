"""Tournaments: matches in which submissions play against and with each other."""
