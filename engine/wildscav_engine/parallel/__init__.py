"""Parallel work in threads."""
