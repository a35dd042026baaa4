"""Plans: everything that defines a run of matches, its jobs, and the results that they add up to."""
