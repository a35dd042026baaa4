"""Size-limited reads, atomic writes, and the layout of the engine's own binary files."""
