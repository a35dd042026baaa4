"""Boards: who leads on each track, by how much, and how it came about."""
