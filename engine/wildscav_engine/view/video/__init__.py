"""Videos and pictures of recorded matches, in the engine's own renderer.

Pillow and PyAV are imported when something is drawn or written.
"""

# The suffixes of what can be written.
MP4 = ".mp4"
VIDEOS = (MP4, ".gif", ".webp")
PICTURES = (".png", ".webp", ".jpg", ".jpeg")
