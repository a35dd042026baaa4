"""How much room the disks have. While there is too little, nothing is begun or taken in."""

import shutil
from pathlib import Path

from wildscav_evaluator.cache import cache_folder
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import UnavailableError

FLOOR = 1 << 30  # bytes that must be free


def free_bytes(season: Season) -> dict[str, int]:
    """Return how many bytes are free for the files of a season, and for what can be recreated."""
    folders = {"season": season.folder, "cache": cache_folder("submissions")}
    return {name: shutil.disk_usage(_existing(folder)).free for name, folder in folders.items()}


def check_room(season: Season) -> None:
    """Check that the disks have room for new work.

    Raises:
        UnavailableError: One of them has too little.
    """
    for name, free in free_bytes(season).items():
        if free < FLOOR:
            raise UnavailableError(
                f"the disk of the {name} has {free / 2**30:.2f} GiB left: nothing new is begun or taken in "
                f"until the organizers make room for {FLOOR / 2**30:g} GiB"
            )


def _existing(folder: Path) -> Path:
    return next(path for path in (folder, *folder.parents) if path.exists())
