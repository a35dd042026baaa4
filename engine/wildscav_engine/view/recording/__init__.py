"""What all of a replay stands on: the match re-simulated into arrays, its frame of reference, colours."""
