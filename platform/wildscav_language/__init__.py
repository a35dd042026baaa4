"""Seats for those who read and write: what an agent senses as text, and what it may do as tools."""
