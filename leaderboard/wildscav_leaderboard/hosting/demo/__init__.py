"""A season to look at: the baselines as teams, on small maps, on this machine."""
