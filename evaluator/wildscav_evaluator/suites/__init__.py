"""Suites: which matches evaluate a submission, and where their seeds come from."""
