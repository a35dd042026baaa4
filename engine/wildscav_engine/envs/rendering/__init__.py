"""Rendering of environments: images, and a live view."""
