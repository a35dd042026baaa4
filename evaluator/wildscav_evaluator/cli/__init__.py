"""The commands of an organizer and a competitor: what they are asked for, and what they say."""
