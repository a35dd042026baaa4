"""Storing what a season sends as a file: whole and as it was announced, or not at all."""

import os
from collections.abc import Iterable
from pathlib import Path

from wildscav.errors import UserError, describe


def is_stored(path: Path, digest: str) -> bool:
    """Return whether a file is the record with a digest.

    Raises:
        OSError: There is a file, but it cannot be read, or is no record.
    """
    from wildscav_evaluator.output.journal import file_digest

    return path.exists() and file_digest(path) == digest


def store_record(pieces: Iterable[bytes], digest: str, path: Path) -> None:
    """Write the record of a match into a new file.

    Raises:
        UserError: It has another digest, is too large, or the file cannot be written.
    """
    fresh = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        _write(pieces, fresh)
        if not is_stored(fresh, digest):
            raise UserError("the download is not the record that the season names: its digest is another")
        fresh.rename(path)
    except OSError as error:
        raise UserError(f"cannot store {path}: {error.strerror or describe(error)}") from None
    finally:
        fresh.unlink(missing_ok=True)


def _write(pieces: Iterable[bytes], path: Path) -> None:
    from wildscav_engine.record import FILE_LIMIT

    size = 0
    with path.open("wb") as file:
        for piece in pieces:
            size += file.write(piece)
            if size > FILE_LIMIT:
                raise UserError(f"the download has more than {FILE_LIMIT >> 20} MiB, as no record has")
