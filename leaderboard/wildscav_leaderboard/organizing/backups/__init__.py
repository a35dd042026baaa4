"""Backups of a season while it runs: settings, database and files in one tar, and the way back."""
