"""What all files of the output folder that hold JSON are made of.

A folder may be anybody's, so its files are read with limits. What a small file makes of itself in memory is
little. A large one is read in a limited process first, and here only if it fits into that.
"""

import json
from pathlib import Path
from typing import Any, Self

from pydantic import BaseModel, ConfigDict, ValidationError

from wildscav.errors import UserError
from wildscav.system.limited_process import LimitExceededError, call_limited
from wildscav.terminal.console import ascii_json
from wildscav_engine.specs.validation import one_line
from wildscav_engine.storage.files import read_limited, write_whole

LARGEST = 32 << 20  # bytes of a file
MEMORY = 128 << 20  # bytes that a large file may take: who waits for it takes as much already
SMALL = 256 << 10  # bytes of one that is read at once


class FileModel(BaseModel):
    """Base of everything in such a file, and of the file itself."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read a file.

        Raises:
            FileModelError: It is too large, or not of this kind.
            OSError: It cannot be read.
        """
        return cls.parse(read_after_trial(path, f"{cls.__module__}:{cls.__qualname__}.try_file"))

    @classmethod
    def try_file(cls, path: str) -> None:
        """Read a file in the process that calls it, and keep nothing.

        Raises:
            FileModelError: It is not of this kind.
            OSError: It cannot be read.
        """
        cls.parse(read_limited(Path(path), LARGEST))

    @classmethod
    def parse(cls, content: bytes) -> Self:
        """Return the part that some bytes are.

        Raises:
            FileModelError: They are none.
        """
        try:
            return cls.model_validate_json(content)
        except ValidationError as error:
            raise FileModelError(one_line(error)) from None

    def as_json(self) -> Any:
        """Return this as the values that JSON has."""
        return json.loads(self.model_dump_json())

    def write(self, path: Path) -> Path:
        """Write this as a file, whole or not at all, and return its path.

        Raises:
            OSError: It cannot be written.
        """
        write_whole(path, ascii_json(self.model_dump_json(indent=1)).encode("ascii") + b"\n")
        return path


class FileModelError(UserError):
    """A file is not what it should be; the message is one line that says why, without the file's name."""


def read_after_trial(path: Path, trial: str) -> bytes:
    """Return the content of a file; a large one is read on trial first, in a limited process.

    Args:
        path: The file.
        trial: What reads it there as the caller will, as ``call_limited`` takes it; it is given the path. Its
            module is imported before memory is counted.

    Raises:
        FileModelError: A large file cannot be read, or takes too much time or memory.
        OSError: A file cannot be read.
    """
    large = path.stat().st_size > SMALL
    if large:
        try:
            call_limited(trial, str(path), memory=MEMORY)
        except LimitExceededError as error:
            raise FileModelError(f"to read it would cost too much: {error}") from None
        except UserError as error:
            raise FileModelError(str(error)) from None
    return read_limited(path, LARGEST if large else SMALL)
