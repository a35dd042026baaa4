"""Submissions as archives, which are unpacked as if an adversary had written them.

Names must stay inside the folder, only plain files and folders are allowed, and bytes are counted as they are
unpacked, regardless of what the archive claims. Unpacking happens in a process with limits, since the headers
of an archive may demand any amount of memory and time. Nothing is left of an archive that is refused.
"""

import contextlib
import hashlib
import lzma
import shutil
import stat
import tarfile
import tempfile
import zipfile
import zlib
from collections.abc import Callable, Generator
from dataclasses import dataclass
from functools import partial
from pathlib import Path, PurePosixPath
from typing import IO

from wildscav.errors import UserError
from wildscav.system.limited_process import LimitExceededError, call_limited
from wildscav_evaluator.cache import cache_folder, is_kept, prune
from wildscav_evaluator.submission_files import LEFT_OUT

SUFFIXES = (".zip", ".tar.gz", ".tgz")
LARGEST = 256 << 20  # bytes of an archive
LARGEST_CONTENT = 1 << 30  # bytes of all files in it
MAX_ENTRIES = 10_000
LONGEST_NAME = 240  # bytes of a path
DEEPEST = 20  # folders
CHUNK = 1 << 16  # bytes
MACOS = ("__MACOSX", ".DS_Store", "._")  # how names begin that macOS adds beside the folder that it packs
BROKEN = (
    *(zipfile.BadZipFile, tarfile.TarError, zlib.error, lzma.LZMAError),
    *(EOFError, ValueError, NotImplementedError),
    *(FileExistsError, NotADirectoryError, IsADirectoryError),  # one name for a file and for a folder
)


class ArchiveError(UserError):
    """An archive is not valid as a submission."""

    def __init__(self, message: str) -> None:
        super().__init__(message, exit_code=2)


class TooLargeError(Exception):
    """A file has more content than is allowed."""


@dataclass(frozen=True)
class Entry:
    """One entry of an archive."""

    name: str
    kind: str  # "file", "folder", or a description of a kind that is not allowed
    executable: bool
    open: Callable[[], IO[bytes] | None]  # opens the content of a file


def is_archive(path: Path) -> bool:
    """Return whether a path has the suffix of an archive."""
    return path.name.lower().endswith(SUFFIXES)


def unpack(archive: Path, cache: Path | None = None, largest: int = LARGEST_CONTENT) -> Path:
    """Return a folder with an archive's content, from the cache if the same content was unpacked before.

    If a single folder holds everything, as many programs pack it, that folder is returned. All files together
    have at most ``largest`` bytes. ArchiveError says which entry is not allowed, and what is.
    """
    size = archive.stat().st_size
    if size > LARGEST:
        raise ArchiveError(f"{archive} has {_mebibytes(size)}, may have {_mebibytes(LARGEST)} at most")
    with archive.open("rb") as file:
        digest = hashlib.file_digest(file, "blake2b").hexdigest()[:32]
    target = (cache or cache_folder("submissions")) / digest
    if not is_kept(target):
        _unpack_new(archive, target, largest)
    return _inner(target)


def _unpack_new(archive: Path, target: Path, largest: int) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    prune(target.parent)
    fresh = Path(tempfile.mkdtemp(prefix="unpacking-", dir=target.parent))
    function = f"{__name__}:unpack_into"
    try:
        fresh.chmod(0o755)
        call_limited(function, str(archive), str(fresh), largest, MAX_ENTRIES)
        with contextlib.suppress(OSError):  # another process was quicker
            fresh.rename(target)
    except LimitExceededError as error:
        raise ArchiveError(f"{archive} cannot be unpacked: {error}") from None
    except UserError as error:
        raise ArchiveError(str(error)) from None
    finally:
        shutil.rmtree(fresh, ignore_errors=True)


def unpack_into(archive: str, folder: str, largest_content: int, most_entries: int) -> None:
    """Unpack an archive into an empty folder, in the calling process. See ``unpack``."""
    try:
        _write_all(Path(archive), Path(folder), largest_content, most_entries)
    except BROKEN as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise ArchiveError(f"{archive} cannot be unpacked: {reason}") from None


def _inner(folder: Path) -> Path:
    entries = [entry for entry in folder.iterdir() if not entry.name.startswith(MACOS)]
    return entries[0] if len(entries) == 1 and entries[0].is_dir() else folder


def _write_all(archive: Path, folder: Path, largest_content: int, most_entries: int) -> None:
    left, seen = largest_content, set[str]()
    with contextlib.closing(_entries(archive)) as entries:
        for count, entry in enumerate(entries, start=1):
            if count > most_entries:
                raise ArchiveError(f"{archive} has more than {most_entries:,} entries")
            path = _checked_path(archive, entry)
            if path is None or entry.kind == "folder":
                continue
            # On file systems that ignore case, one file would replace the other.
            if str(path).lower() in seen:
                raise ArchiveError(f"{archive}: {_shown(entry.name)} is there twice")
            seen.add(str(path).lower())
            try:
                left -= _write(archive, entry, folder / path, left)
            except TooLargeError:
                raise ArchiveError(f"{archive} unpacks to more than {_mebibytes(largest_content)}") from None


def _write(archive: Path, entry: Entry, path: Path, left: int) -> int:
    """Write a file's content and return its size in bytes; TooLargeError if there is more than ``left``."""
    written = 0
    path.parent.mkdir(parents=True, exist_ok=True)
    content = entry.open()
    if content is None:
        raise ArchiveError(f"{archive}: {_shown(entry.name)} has no content")
    with content as source, path.open("xb") as target:
        while chunk := source.read(CHUNK):
            written += len(chunk)
            if written > left:
                raise TooLargeError
            target.write(chunk)
    path.chmod(0o755 if entry.executable else 0o644)
    return written


def _checked_path(archive: Path, entry: Entry) -> Path | None:
    """Return an entry's path in its folder; None if it is the folder itself or not part of a submission."""
    name, where = entry.name, f"{archive}: {_shown(entry.name)}"
    if entry.kind not in ("file", "folder"):
        raise ArchiveError(f"{where} is {entry.kind}: an archive may have plain files and folders only")
    if not name.isprintable() or "\\" in name or len(name.encode("utf-8", "replace")) > LONGEST_NAME:
        raise ArchiveError(
            f"{where} is not allowed: a name must be printable, without \\, at most {LONGEST_NAME} bytes"
        )
    path = PurePosixPath(name)
    if path.is_absolute() or ".." in path.parts or (path.parts and path.parts[0].endswith(":")):
        raise ArchiveError(f"{where} leads out of the archive's folder")
    if len(path.parts) > DEEPEST:
        raise ArchiveError(f"{where} is more than {DEEPEST} folders deep")
    return Path(*path.parts) if path.parts and LEFT_OUT.isdisjoint(path.parts) else None


def _entries(archive: Path) -> Generator[Entry, None, None]:
    if archive.name.lower().endswith(".zip"):
        yield from _zip_entries(archive)
    else:
        yield from _tar_entries(archive)


def _zip_entries(archive: Path) -> Generator[Entry, None, None]:
    with zipfile.ZipFile(archive) as file:
        for info in file.infolist():
            mode = info.external_attr >> 16
            if info.flag_bits & 1:
                raise ArchiveError(f"{archive}: {_shown(info.filename)} is encrypted")
            kind = "folder" if info.is_dir() else _kind(mode)
            yield Entry(info.filename, kind, bool(mode & stat.S_IXUSR), partial(file.open, info))


def _kind(mode: int) -> str:
    """Return the kind of a file from its mode in a zip, which many programs leave 0."""
    if stat.S_IFMT(mode) in (0, stat.S_IFREG):
        return "file"
    return "a link" if stat.S_ISLNK(mode) else "a special file"


def _tar_entries(archive: Path) -> Generator[Entry, None, None]:
    # As a stream, so that the archive is unpacked only as far as it is read.
    with tarfile.open(archive, "r|gz") as file:
        for info in file:
            kind = "file" if info.isreg() else "folder" if info.isdir() else "a special file"
            kind = "a link" if info.issym() or info.islnk() else kind
            if info.issparse():
                kind = "a sparse file"
            yield Entry(info.name, kind, bool(info.mode & stat.S_IXUSR), partial(file.extractfile, info))


def _shown(name: str) -> str:
    """Return a name in a printable form on one line."""
    text = name.encode("unicode_escape").decode("ascii")
    return repr(text if len(text) <= 80 else f"{text[:77]}...")


def _mebibytes(size: int) -> str:
    return f"{size / (1 << 20):,.0f} MiB"
