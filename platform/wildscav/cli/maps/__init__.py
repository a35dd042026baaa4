"""The commands about maps: ``wildscav map`` and ``wildscav look``."""
