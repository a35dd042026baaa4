"""The commands that Typer offers, with their arguments and options."""
