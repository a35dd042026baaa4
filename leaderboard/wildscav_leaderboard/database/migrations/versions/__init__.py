"""One file for every version."""
