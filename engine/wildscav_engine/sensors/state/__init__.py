"""Sensors of numbers: what the state of a match and what is seen of it tell, without images."""
