"""The folder of everything that is cached about kernels."""

import atexit
import functools
import os
import shutil
import tempfile
from pathlib import Path


def cache_root() -> Path:
    """Return the folder of all compiled code: in WILDSCAV_CACHE_DIR, or in the user's cache folder.

    For a user without a home directory, such as one of a container, it is in a temporary folder.
    """
    if named := os.environ.get("WILDSCAV_CACHE_DIR"):
        return Path(named) / "kernels"
    try:
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "wildscav" / "kernels"
    except RuntimeError:
        return temporary_folder() / "kernels"


@functools.cache
def temporary_folder() -> Path:
    """Create a folder that is removed when this process ends."""
    folder = Path(tempfile.mkdtemp(prefix="wildscav-kernels-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder
