"""Readings of sensors as pictures for people."""
