"""Videos and pictures of recorded matches, in the engine's own renderer.

Pillow and PyAV are imported when something is drawn or written.
"""
