"""Trees, bushes and rocks: what they look like and where they grow."""
