"""Checks of the folders that commands write into, made before anything is written."""

from pathlib import Path

from wildscav.errors import UserError


def check_folder(option: str, path: Path, *, is_default: bool = False) -> None:
    """Raise a UserError where no folder can be created at an option's path: it, or a parent, is a file."""
    there = next((each for each in (path, *path.parents) if each.exists()), path)
    if there.exists() and not there.is_dir():
        above = "" if there == path else f" cannot be made: {there}"
        what, advice = (path, f"one with {option}") if is_default else (f"{option} {path}", "another")
        raise UserError(f"{what}{above} is not a folder: name {advice}", exit_code=2)
