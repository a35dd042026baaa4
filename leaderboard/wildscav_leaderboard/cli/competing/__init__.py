"""The commands of competitors: log in, submit, and see what became of it."""
