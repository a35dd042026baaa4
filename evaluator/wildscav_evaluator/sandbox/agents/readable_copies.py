"""Copies of submissions that agents can read as a user who owns nothing."""

import os
import shutil
from pathlib import Path


def readable_copy(folder: Path, private: Path) -> Path:
    """Copy a folder into a private one, readable for every user with access to it; return the copy.

    Raises:
        OSError: It could not be copied.
    """
    copy = private / "submission"
    shutil.copytree(folder, copy, symlinks=True)
    make_readable(copy)
    return copy


def make_readable(folder: Path) -> None:
    """Let every user read a folder and everything in it except symbolic links."""
    for base, _, files in os.walk(folder):
        Path(base).chmod(0o755)
        for name in files:
            path = Path(base) / name
            if not path.is_symlink():
                path.chmod(0o755 if path.stat().st_mode & 0o100 else 0o644)
