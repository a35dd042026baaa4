"""Work over threads."""
