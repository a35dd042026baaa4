"""Shapes of the world, the grid over them, rays and sweeps."""
