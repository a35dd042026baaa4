"""What pages show of a match: trails, maps, replays, and the Rerun web viewer."""
