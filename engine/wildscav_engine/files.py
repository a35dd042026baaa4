"""Files that are there whole or not at all."""

import os
from pathlib import Path


def write_whole(path: Path, content: bytes) -> None:
    """Write a file so that no reader, and no crash, ever sees half of it.

    What is there already and is no file, such as a device or a pipe, is written to and not replaced.

    Raises:
        OSError: It cannot be written; the error names the path. An older file stays as it was.
    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        if path.exists() and not path.is_file():
            path.write_bytes(content)
        else:
            part.write_bytes(content)
            part.replace(path)
    except OSError as error:
        # A full disk is noticed in the middle of a write, and that error does not say where.
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        part.unlink(missing_ok=True)
