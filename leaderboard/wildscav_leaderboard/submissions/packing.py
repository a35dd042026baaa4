"""Packing a submission's folder into an archive: equal submissions give equal archives."""

import gzip
import os
import tarfile
from pathlib import Path

from wildscav_evaluator.submission_files import add_files


def pack(folder: Path, archive: Path) -> None:
    """Write the files of a submission as a ``.tar.gz``.

    Raises:
        UserError: The folder has what no submission may have, such as a link to a folder.
        OSError: A file cannot be read, or the archive cannot be written; then there is none.
    """
    fresh = archive.with_name(f".{archive.name}.{os.getpid()}")
    try:
        with (
            fresh.open("wb") as raw,
            gzip.GzipFile("", "wb", 6, raw, mtime=0) as packed,
            tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as tar,
        ):
            add_files(tar, folder)
        fresh.rename(archive)
    finally:
        fresh.unlink(missing_ok=True)
