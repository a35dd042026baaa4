"""Auditing a season from what is published of it, as anyone can: nothing that it says is believed."""
