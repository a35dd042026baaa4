"""The options of environments: their config, presets, and the seed and map of each episode."""
