"""The commands for organizers and competitors: their options, and their output."""
