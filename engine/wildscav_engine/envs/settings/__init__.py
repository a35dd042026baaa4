"""The options of environments: their config, presets, and what each episode is played on."""
