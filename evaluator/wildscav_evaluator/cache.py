"""What is kept between runs, and can be made again."""

import os
from pathlib import Path


def cache_folder(name: str) -> Path:
    """Return the folder of one kind of thing: in WILDSCAV_CACHE_DIR, or the user's cache folder."""
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(os.environ.get("WILDSCAV_CACHE_DIR") or Path(home) / "wildscav") / name
