"""The basis of replays: the match re-simulated into arrays, coordinates, colours and time columns."""
