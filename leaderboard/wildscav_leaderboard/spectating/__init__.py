"""What pages show of a match: trails, the map from above, replays, and the Rerun web viewer."""
