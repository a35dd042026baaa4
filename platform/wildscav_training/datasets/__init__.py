"""Data sets of episodes, for learners that imitate and for offline learning: from records, or of an agent."""
