"""Packing a submission's folder into an archive: equal folders give equal archives."""

import gzip
import os
import tarfile
from pathlib import Path

from wildscav.errors import UserError
from wildscav_evaluator.submissions.submission import IGNORED_FOLDERS


def pack(folder: Path, archive: Path) -> None:
    """Write a folder as a ``.tar.gz``, without what tools leave behind.

    Links to files are replaced by the files. Times, owners and the order of files do not matter.

    Raises:
        UserError: It has a link to a folder.
        OSError: A file cannot be read, or the archive cannot be written; then there is none.
    """
    fresh = archive.with_name(f".{archive.name}.{os.getpid()}")
    try:
        with (
            fresh.open("wb") as raw,
            gzip.GzipFile("", "wb", 6, raw, mtime=0) as packed,
            tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT, dereference=True) as tar,
        ):
            for path in files_of(folder):
                _add(tar, path, path.relative_to(folder))
        fresh.rename(archive)
    finally:
        fresh.unlink(missing_ok=True)


def files_of(folder: Path) -> list[Path]:
    """Return the files of a submission's folder, sorted.

    Raises:
        UserError: It has a link to a folder, which may lead anywhere, even in a circle.
    """
    found = (
        path for path in folder.rglob("*") if not IGNORED_FOLDERS.intersection(path.relative_to(folder).parts)
    )
    files = []
    for path in found:
        if path.is_symlink() and path.is_dir():
            raise UserError(f"{path} is a link to a folder, which cannot be packed: put a copy there", 2)
        if path.is_file():
            files.append(path)
    return sorted(files)


def _add(tar: tarfile.TarFile, path: Path, name: Path) -> None:
    info = tar.gettarinfo(path, name.as_posix())
    info.uid = info.gid = info.mtime = 0
    info.uname = info.gname = ""
    info.mode = 0o755 if os.access(path, os.X_OK) else 0o644
    with path.open("rb") as file:
        tar.addfile(info, file)
