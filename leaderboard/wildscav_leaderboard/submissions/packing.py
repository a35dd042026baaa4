"""Packing a submission's folder into an archive: equal submissions give equal archives."""

import gzip
import os
import tarfile
from io import FileIO
from pathlib import Path
from typing import Any

from wildscav.errors import UserError
from wildscav_evaluator.submission_files import add_files, submission_files


def pack(folder: Path, archive: Path, largest: int | None = None) -> None:
    """Write the files of a submission as a ``.tar.gz`` of at most ``largest`` MiB.

    Raises:
        UserError: The folder has what no submission may have, such as a link to a folder, or is too large.
        OSError: A file cannot be read, or the archive cannot be written; then there is none.
    """
    fresh = archive.with_name(f".{archive.name}.{os.getpid()}")
    try:
        with (
            _Limited(fresh, folder, largest) as raw,
            gzip.GzipFile("", "wb", 6, raw, mtime=0) as packed,
            tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as tar,
        ):
            add_files(tar, folder)
        fresh.rename(archive)
    finally:
        fresh.unlink(missing_ok=True)


class _Limited(FileIO):
    """A file to write that refuses to grow beyond some MiB, whatever is still to come."""

    def __init__(self, path: Path, folder: Path, largest: int | None) -> None:
        super().__init__(path, "wb")
        self._folder, self._largest = folder, largest

    def write(self, content: Any) -> int:
        if self._largest is not None and self.tell() + len(content) > self._largest << 20:
            big = max(submission_files(self._folder), key=lambda path: path.stat().st_size)
            raise UserError(
                f"{self._folder} packs to more than {self._largest} MiB, which is the most that the season "
                f"takes; its largest file is {big.relative_to(self._folder)} "
                f"({big.stat().st_size / (1 << 20):,.0f} MiB)"
            )
        return super().write(content)
