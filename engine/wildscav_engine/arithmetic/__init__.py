"""Arithmetic that gives the same bits on every machine: elementary functions, random numbers, hashes."""
