"""Size-limited reads and atomic writes of files."""

import errno
import io
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def read_limited(path: Path, limit: int) -> bytes:
    """Return the content of a regular file from an untrusted source, without blocking.

    Args:
        path: The file.
        limit: The maximum size in bytes.

    Raises:
        OSError: The file cannot be read, is not a regular file, or is larger; the error names the path.
    """
    nonblocking = getattr(os, "O_NONBLOCK", 0)  # which Windows lacks
    opened = io.FileIO(path, opener=lambda name, flags: os.open(name, flags | nonblocking))
    with io.BufferedReader(opened) as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            raise OSError(errno.EINVAL, "it is not a plain file", str(path))
        content = file.read(limit + 1)
    if content is None:  # such as files in /proc that have no data yet
        raise OSError(errno.EAGAIN, "it is not a plain file", str(path))
    if len(content) > limit:
        raise OSError(errno.EFBIG, f"it has more than {limit:,} bytes", str(path))
    return content


def write_whole(path: Path, content: bytes) -> None:
    """Write a file so that neither readers nor a crash ever leave half of it.

    An existing path that is not a regular file, such as a device or a pipe, is written to and not replaced.

    Raises:
        OSError: It cannot be written; the error names the path. An older file stays unchanged.
    """
    if path.exists() and not path.is_file():
        with _errors_naming(path):
            path.write_bytes(content)
    else:
        with part_of(path) as part:
            part.write_bytes(content)


@contextmanager
def part_of(path: Path) -> Iterator[Path]:
    """Yield the name of a file that becomes ``path`` once it is whole, and is deleted after any error.

    Raises:
        OSError: It cannot be written; the error names the path. An older file stays unchanged.
    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with _errors_naming(path):
            yield part
            part.replace(path)
    finally:
        part.unlink(missing_ok=True)


@contextmanager
def _errors_naming(path: Path) -> Iterator[None]:
    """Let errors name a path: those of a full disk and of encoders name another file, or none."""
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), str(path)) from error
