"""Files that say what is to be played, suites and maps: they may be anybody's, and are read with limits."""

from pathlib import Path

from wildscav.errors import UserError
from wildscav.system.limited_process import LimitExceededError, call_limited
from wildscav_engine.storage.files import read_limited

LARGEST = 1 << 20  # bytes
SMALL = 4 << 10  # bytes of one that costs little, whatever is in it
MEMORY = 96 << 20  # bytes that a larger one may take


def read_config(path: Path, trial: str) -> bytes:
    """Return the content of a file; a larger one is read on trial first, in a limited process.

    Args:
        path: The file.
        trial: What reads it there as the caller will, "module:function"; it is given the path.

    Raises:
        UserError: To read it would cost too much, or it is not as it must be.
        OSError: It cannot be read, is no plain file, or is too large.
    """
    content = read_limited(path, LARGEST)
    if len(content) > SMALL:
        try:
            call_limited(trial, str(path), memory=MEMORY)
        except LimitExceededError as error:
            raise UserError(f"{path}: to read it would cost too much: {error}", exit_code=2) from None
    return content
