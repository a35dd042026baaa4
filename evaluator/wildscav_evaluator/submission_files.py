"""The files that are a submission, and folders with exactly these for agents to run from.

A file counts with its path, its content, and whether it is executable. Nothing else of a folder counts: not
what tools leave behind (such as compiled Python, which need not do what its source says), nor empty folders,
owners and other rights. A link counts as the file that it leads to.
"""

import os
import shutil
import stat
import tarfile
from pathlib import Path

from wildscav_server.hosting.manifest import SubmissionError

# Files and folders that tools leave behind, at any depth.
LEFT_OUT = frozenset({"__pycache__", ".git", ".venv", ".mypy_cache", ".ruff_cache", ".pytest_cache"})


def submission_files(folder: Path) -> list[Path]:
    """Return the files of a folder that are its submission, sorted.

    SubmissionError if a link leads to a folder, out of the submission or in a circle, if an entry is not a
    file, a folder or a link, or if a folder cannot be read.
    """
    files = []
    for base, folders, names in os.walk(folder, onerror=_refuse):
        folders[:] = [name for name in folders if name not in LEFT_OUT]
        for path in (Path(base, name) for name in (*folders, *names) if name not in LEFT_OUT):
            if path.is_symlink():
                _check_link(path, folder)
            elif not (path.is_file() or path.is_dir()):
                what = "a pipe, a socket or a device"
                raise SubmissionError(
                    f"{path} is {what}: a submission may have only files, folders and links"
                )
            if path.is_file():
                files.append(path)
    return sorted(files)


def _refuse(error: OSError) -> None:
    raise SubmissionError(f"{error.filename} cannot be read: {error.strerror}") from error


def _check_link(path: Path, folder: Path) -> None:
    try:
        target = path.resolve()
    except (RuntimeError, OSError):
        raise SubmissionError(f"{path} is a link that leads in a circle") from None
    if not target.is_relative_to(folder.resolve()):
        raise SubmissionError(f"{path} is a link that leads out of the submission's folder")
    if target.is_dir():
        raise SubmissionError(f"{path} is a link to a folder, which no submission may have: put a copy there")


def is_executable(path: Path) -> bool:
    """Return whether a file of a submission is executable."""
    return bool(path.stat().st_mode & stat.S_IXUSR)


def stage(folder: Path, private: Path) -> Path:
    """Return a folder with exactly a submission's files, which every user may read.

    It is the submission's own if that has nothing else, otherwise a copy in ``private``, for whoever may
    enter that. Errors: see ``submission_files``.
    """
    return folder if _has_nothing_else(folder) else copy_files(folder, private / "submission")


def _has_nothing_else(folder: Path) -> bool:
    for base, folders, names in os.walk(folder):
        inside = [*folders, *names]
        if not inside or not LEFT_OUT.isdisjoint(inside):
            return False
        if not all(_is_as_copied(Path(base, name)) for name in inside):
            return False
    return _is_as_copied(folder)


def _is_as_copied(path: Path) -> bool:
    """Return whether a file or folder gives others the rights that a copy would."""
    mode = path.lstat().st_mode
    if stat.S_ISDIR(mode):
        return mode & 0o005 == 0o005
    return stat.S_ISREG(mode) and mode & 0o6005 == (0o005 if mode & stat.S_IXUSR else 0o004)


def copy_files(folder: Path, copy: Path) -> Path:
    """Copy a submission's files into a new folder, which every user may read; return it."""
    for path in submission_files(folder):
        target = copy / path.relative_to(folder)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, target)
        target.chmod(0o755 if is_executable(path) else 0o644)
    for base, _, _ in os.walk(copy):
        Path(base).chmod(0o755)
    return copy


def add_files(archive: tarfile.TarFile, folder: Path) -> None:
    """Add a submission's files to an archive: equal submissions give equal bytes."""
    for path in submission_files(folder):
        info = tarfile.TarInfo(path.relative_to(folder).as_posix())
        info.size = path.stat().st_size
        info.mode = 0o755 if is_executable(path) else 0o644
        with path.open("rb") as file:
            archive.addfile(info, file)
