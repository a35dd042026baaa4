"""Files: read up to a limit, written whole or not at all, and the layout of the engine's own binary files."""
