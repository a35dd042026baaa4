"""The archive of a backup: a tar whose last entry has the SHA-256 of every other one."""

import hashlib
import io
import tarfile
from pathlib import Path, PurePosixPath
from typing import IO

from wildscav.errors import UserError

SUMS = "sha256sums.txt"
PIECE = 1 << 20  # bytes


class BackupError(UserError):
    """A backup is damaged, or is none."""


class Writer:
    """Adds files to an archive, and notes their sums."""

    def __init__(self, file: IO[bytes]) -> None:
        self._tar = tarfile.TarFile(fileobj=file, mode="w", format=tarfile.PAX_FORMAT)
        self._sums: dict[str, str] = {}

    def add(self, path: Path, name: str) -> None:
        """Add a file as it is now. What is appended meanwhile is left out.

        Raises:
            OSError: It cannot be read, or became shorter meanwhile.
        """
        with path.open("rb") as file:
            info = self._tar.gettarinfo(name, name, file)
            info.uid = info.gid = 0
            info.uname = info.gname = ""
            summed = _Summed(file)
            self._tar.addfile(info, summed)
        self._sums[name] = summed.sum.hexdigest()

    def add_text(self, text: str, name: str) -> None:
        """Add a text as a file."""
        content = text.encode()
        info = tarfile.TarInfo(name)
        info.size = len(content)
        self._tar.addfile(info, io.BytesIO(content))
        self._sums[name] = hashlib.sha256(content).hexdigest()

    def close(self) -> None:
        """Add the sums, and end the archive."""
        self.add_text("".join(f"{digest}  {name}\n" for name, digest in sorted(self._sums.items())), SUMS)
        self._tar.close()


class _Summed(io.RawIOBase):
    """A file that is read once, with the sum of what was read."""

    def __init__(self, file: IO[bytes]) -> None:
        self._file, self.sum = file, hashlib.sha256()

    def read(self, size: int = -1) -> bytes:
        """Return the next bytes."""
        content = self._file.read(size)
        self.sum.update(content)
        return content


def extract(archive: Path, folder: Path) -> None:
    """Extract an archive into an empty folder, and check the sum of every file.

    Raises:
        BackupError: It is damaged or incomplete, or has something in it that no backup has.
        OSError: It cannot be read, or the folder cannot be written.
    """
    sums: dict[str, str] = {}
    try:
        with tarfile.open(archive, "r:") as tar:
            for info in tar:
                if not info.isfile() or not _is_inside(info.name) or info.name in sums:
                    raise BackupError(f"{archive} is no backup of a season: it has an entry {info.name!r}")
                sums[info.name] = _extract(tar, info, folder / info.name)
    except tarfile.TarError as error:
        raise BackupError(f"{archive} is no backup of a season, or is damaged: {error}") from error
    if SUMS not in sums:
        raise BackupError(f"{archive} is no backup of a season, or its end is missing")
    del sums[SUMS]
    lines = (folder / SUMS).read_text("utf-8", "replace").splitlines()
    told = {name: digest for digest, _, name in (line.partition("  ") for line in lines)}
    for name in sorted(told | sums):
        if told.get(name) != sums.get(name):
            raise BackupError(f"{archive} is damaged: {name} is not what was backed up")
    (folder / SUMS).unlink()


def _is_inside(name: str) -> bool:
    path = PurePosixPath(name)
    return bool(name) and not path.is_absolute() and ".." not in path.parts and "\0" not in name


def _extract(tar: tarfile.TarFile, info: tarfile.TarInfo, target: Path) -> str:
    """Write an entry to a new file, and return its sum."""
    content, total = tar.extractfile(info), hashlib.sha256()
    if content is None:
        raise BackupError(f"{info.name} is no file")
    target.parent.mkdir(parents=True, exist_ok=True)
    with target.open("xb") as file:
        target.chmod(info.mode & 0o700)
        while piece := content.read(PIECE):
            file.write(piece)
            total.update(piece)
    return total.hexdigest()
