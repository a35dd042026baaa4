"""Configuration files of suites and maps. They may be untrusted, so they are read with limits."""

from pathlib import Path

from wildscav.errors import UserError
from wildscav.system.limited_process import LimitExceededError, call_limited
from wildscav_engine.storage.files import read_limited

LARGEST = 1 << 20  # bytes
SMALL = 4 << 10  # bytes; reading a file of this size is cheap, whatever it contains
MEMORY = 96 << 20  # bytes of memory that reading a larger file may take


def read_config(path: Path, trial: str) -> bytes:
    """Return the content of a file; a larger one is first parsed on trial in a limited process.

    Args:
        trial: The function that parses the file on trial, as "module:function"; its argument is the path.

    Raises:
        UserError: Parsing the file would cost too much, or its content is invalid.
        OSError: It cannot be read, is not a regular file, or is too large.
    """
    content = read_limited(path, LARGEST)
    if len(content) > SMALL:
        try:
            call_limited(trial, str(path), memory=MEMORY)
        except LimitExceededError as error:
            raise UserError(f"{path}: reading it would cost too much: {error}", exit_code=2) from None
    return content
