"""Privileged acts of the organizers, each of which is logged, and what they need to see."""
