"""Checks of the folders that commands write into, made before anything is written."""

from pathlib import Path

from wildscav.errors import UserError


def check_folder(option: str, path: Path) -> None:
    """Raise a UserError where no folder can be created at an option's path: it, or a parent, is a file."""
    there = next((each for each in (path, *path.parents) if each.exists()), path)
    if there.exists() and not there.is_dir():
        above = "" if there == path else f" cannot be made: {there}"
        raise UserError(f"{option} {path}{above} is not a folder: name another", exit_code=2)
