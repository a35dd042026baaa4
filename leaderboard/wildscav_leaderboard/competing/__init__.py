"""Competing in a season from the command line: its commands, and the client that they talk through."""
