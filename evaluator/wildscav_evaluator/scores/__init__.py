"""Scores: computing them from matches, recomputing them from records, and comparing them."""
