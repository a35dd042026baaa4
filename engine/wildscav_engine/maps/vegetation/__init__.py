"""Trees, bushes and rocks: their shapes and positions."""
