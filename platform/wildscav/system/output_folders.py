"""Folders that commands write into, checked before anything is written."""

from pathlib import Path

from wildscav.errors import UserError


def check_folder(option: str, path: Path) -> None:
    """Refuse a path where no folder can be, because something else is there or above it.

    Args:
        option: The option that names it, for the error.
        path: A folder, or where one is to be made.

    Raises:
        UserError: It is no folder and cannot become one.
    """
    there = next((each for each in (path, *path.parents) if each.exists()), path)
    if there.exists() and not there.is_dir():
        above = "" if there == path else f" cannot be made: {there}"
        raise UserError(f"{option} {path}{above} is not a folder: name another", exit_code=2)
