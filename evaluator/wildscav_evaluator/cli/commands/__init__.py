"""The commands that Typer offers: what a user types, and what it means."""
