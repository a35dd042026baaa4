"""Suites: the matches that evaluate a submission, and the origin of their seeds."""
