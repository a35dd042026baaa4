"""The cache: files that are kept between runs and can be recreated."""

import os
from pathlib import Path


def cache_folder(name: str) -> Path:
    """Return the folder for one kind of file, in WILDSCAV_CACHE_DIR or in the user's cache folder."""
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(os.environ.get("WILDSCAV_CACHE_DIR") or Path(home) / "wildscav") / name
