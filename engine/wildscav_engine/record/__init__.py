"""Records: write, read and verify."""
