"""Files: read up to a limit, and written whole or not at all."""

import errno
import io
import os
import stat
from pathlib import Path


def read_limited(path: Path, most: int) -> bytes:
    """Return the content of a plain file that may be anybody's: it cannot be too long, and it cannot block.

    Args:
        path: The file.
        most: Bytes that it may have.

    Raises:
        OSError: It cannot be read, is no plain file, or has more bytes; the error names the path.
    """
    with io.BufferedReader(io.FileIO(path, opener=_open_without_waiting)) as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            raise OSError(errno.EINVAL, "it is not a plain file", str(path))
        content = file.read(most + 1)
    if content is None:  # as of files in /proc that have nothing to say yet
        raise OSError(errno.EAGAIN, "it is not a plain file", str(path))
    if len(content) > most:
        raise OSError(errno.EFBIG, f"it has more than {most:,} bytes", str(path))
    return content


def _open_without_waiting(path: str, flags: int) -> int:
    return os.open(path, flags | os.O_NONBLOCK)


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
