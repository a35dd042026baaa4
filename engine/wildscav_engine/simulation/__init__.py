"""The simulation: the state of matches, the step that plays them, and how they begin and are kept."""
