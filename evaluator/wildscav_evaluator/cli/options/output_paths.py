"""Checks, before a match, that ``wildscav play`` can write its output files."""

import tempfile
from pathlib import Path

from wildscav.cli.replay import check_name
from wildscav.errors import UserError


def check_output_paths(record: Path | None, replay: Path | None) -> None:
    """Check that a record and a replay can be written, if they are requested, and create their folders.

    Raises:
        UserError: One cannot be written, both name the same file, or the replay's name is not valid.
    """
    if record is not None and replay is not None and record.resolve() == replay.resolve():
        raise UserError(f"--record and --replay name the same file {record}: name two files", exit_code=2)
    for option, path in (("--record", record), ("--replay", replay)):
        if path is not None:
            _check_file(option, path)
    if replay is not None:
        check_name("--replay", replay)
    for option, path in (("--record", record), ("--replay", replay)):
        if path is not None:
            _check_writable(option, path)


def _check_file(option: str, path: Path) -> None:
    if path.is_dir():
        raise UserError(f"{option} {path} is a folder: name a file in it", exit_code=2)
    if path.exists() and not path.is_file():
        raise UserError(f"{option} {path} is not a plain file: name another", exit_code=2)


def _check_writable(option: str, path: Path) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # Files are written to a temporary file in the same folder and moved, so the folder must be writable.
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise UserError(f"{option} {path} cannot be written: {error.strerror}", exit_code=2) from error
