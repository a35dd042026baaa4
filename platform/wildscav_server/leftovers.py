"""Temporary resources of a process, and their removal by a later process if their owner was killed.

Each process that needs temporary files has one folder for them. The folder holds a file that the process
keeps locked (flock) for as long as it lives. The kernel releases the lock however the process ends, and
locks work across users, containers and process namespaces. So an owner whose lock can be taken is dead.
Unlike process ids, which are reused, a lock never makes a live owner look dead or a dead one alive.

Resources outside the folder (control groups, containers) are entered in a list in the folder before they are
created. A process that finds the folder of a dead owner removes the resources on the list, then the folder.
"""

import atexit
import contextlib
import fcntl
import functools
import json
import os
import secrets
import shutil
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

PREFIX = "wildscav-"  # of owners' folders
NEW = ".wildscav-new-"  # of folders whose lock is not taken yet
FOLDER = "folder"  # the kind of a temporary folder that lies elsewhere
LOCK, LIST = "owner.lock", "list.jsonl"
SHORT_PLACE = Path("/tmp")  # noqa: S108 - used where the path of temporary files is too long for sockets
LONGEST_PLACE = 40  # bytes of that path; some systems allow only 104 for the path of a socket
GRACE = 60.0  # s after which a folder without its lock counts as abandoned

Undo = Callable[[str], None]
_undo: dict[str, Undo] = {}
_lock = threading.Lock()


def register(kind: str, undo: Undo) -> None:
    """Register how one kind of resource outside the owners' folders is removed.

    Args:
        kind: The kind's name in lists.
        undo: Removes the resource with the entered name; does nothing if it is already gone. If it raises an
            ``OSError`` or ``RuntimeError``, the resource may still exist, and removal is tried again later.
    """
    _undo[kind] = undo


def own_folder() -> Path:
    """Return this process's folder for temporary files, created on first use.

    It is removed when the process ends, or by ``sweep`` in another process if this one was killed.
    """
    with _lock:
        return _folder_of(os.getpid())


def owner() -> str:
    """Return the unique name of this process as an owner."""
    return own_folder().name.removeprefix(PREFIX)


@contextlib.contextmanager
def temporary_folder(prefix: str) -> Iterator[Path]:
    """Create a folder inside this process's own folder, and remove it when the block ends."""
    folder = Path(tempfile.mkdtemp(prefix=prefix, dir=own_folder()))
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@contextlib.contextmanager
def temporary_folder_in(place: Path, prefix: str) -> Iterator[Path]:
    """Make a folder anywhere else, and remove it at the end; a later process does if this one was killed.

    Raises:
        OSError: It cannot be made.
    """
    folder = place.absolute() / f"{prefix}{owner()}-{secrets.token_hex(4)}"
    claim(FOLDER, str(folder))
    try:
        folder.mkdir()
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        if not folder.exists():
            release(FOLDER, str(folder))


def _remove_folder(folder: str) -> None:
    with contextlib.suppress(FileNotFoundError):
        shutil.rmtree(folder)


def claim(kind: str, what: str) -> None:
    """Note in this process's list that it is about to create a resource, named as ``undo`` expects it."""
    _write(kind, what, there=True)


def release(kind: str, what: str) -> None:
    """Note in this process's list that a claimed resource is gone."""
    _write(kind, what, there=False)


def _write(kind: str, what: str, *, there: bool) -> None:
    line = json.dumps([kind, what, there]) + "\n"
    with (own_folder() / LIST).open("a", encoding="utf-8") as file:
        file.write(line)


def sweep() -> None:
    """Remove everything that this user's dead owners have left on this machine.

    It takes a millisecond if there is nothing to remove. What cannot be removed now is left for the next
    sweep.
    """
    for place in _places():
        for folder in place.glob(f"{PREFIX}*/{LOCK}"):
            _sweep_owner(folder.parent)
        for folder in place.glob(f"{NEW}*"):
            with contextlib.suppress(OSError):
                if _is_own(folder) and time.time() - folder.lstat().st_mtime > GRACE:
                    shutil.rmtree(folder, ignore_errors=True)


@functools.cache
def _folder_of(process: int) -> Path:
    """Create the folder of a process. A forked process has another id, so it gets a folder of its own."""
    sweep()
    while True:
        new = Path(tempfile.mkdtemp(prefix=NEW, dir=_place()))
        descriptor = os.open(new / LOCK, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        os.write(descriptor, f"{process}\n".encode())
        folder = new.with_name(PREFIX + new.name.removeprefix(NEW))
        try:
            # The folder gets its visible name only now, so every visible folder has its lock.
            new.rename(folder)
        except OSError:  # this process was stopped for so long that another one has swept its folder
            os.close(descriptor)
            continue
        atexit.register(_remove_at_exit, folder, process, descriptor)
        return folder


def _remove_at_exit(folder: Path, process: int, descriptor: int) -> None:
    if os.getpid() == process:
        with contextlib.suppress(OSError, RuntimeError):
            _remove(folder)
        os.close(descriptor)


def _place() -> Path:
    """Return where to create folders: the temporary folder, unless its path is too long for sockets."""
    place = Path(tempfile.gettempdir())
    return place if len(bytes(place)) <= LONGEST_PLACE or not SHORT_PLACE.is_dir() else SHORT_PLACE


def _places() -> list[Path]:
    return [place for place in {Path(tempfile.gettempdir()), SHORT_PLACE} if place.is_dir()]


def _is_own(path: Path) -> bool:
    """Return whether a path belongs to this user and is not a symbolic link."""
    return path.lstat().st_uid == os.geteuid() and not path.is_symlink()


def _sweep_owner(folder: Path) -> None:
    """Remove what an owner has left, if it is dead."""
    with contextlib.suppress(OSError, RuntimeError):
        if not _is_own(folder):
            return
        descriptor = os.open(folder / LOCK, os.O_RDWR | os.O_NOFOLLOW)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # Another sweep may have removed it after we opened and before we locked it.
            if os.path.samestat((folder / LOCK).stat(), os.fstat(descriptor)):
                _remove(folder)
        finally:
            os.close(descriptor)


def _remove(folder: Path) -> None:
    """Remove the resources on an owner's list, then its folder, with the lock last."""
    for kind, what in _entries(folder / LIST):
        if kind not in _undo:
            raise RuntimeError(f"no function is registered that removes a {kind}")
        _undo[kind](what)
    for entry in list(folder.iterdir()):
        if entry.name == LOCK:
            continue
        if entry.is_dir() and not entry.is_symlink():
            shutil.rmtree(entry)
        else:
            entry.unlink()
    # Without the lock, the rest of the folder is found by this name.
    remains = folder.rename(folder.with_name(NEW + folder.name.removeprefix(PREFIX)))
    (remains / LOCK).unlink()
    remains.rmdir()


def _entries(path: Path) -> list[tuple[str, str]]:
    """Return the entries of a list that are not released. Damaged lines are skipped.

    If the last line is incomplete, the process was killed before it created the resource.
    """
    entries: dict[tuple[str, str], bool] = {}
    with contextlib.suppress(FileNotFoundError):
        for line in path.read_text("utf-8").splitlines():
            with contextlib.suppress(ValueError, TypeError):
                kind, what, there = json.loads(line)
                entries[kind, what] = there
    return [entry for entry, there in entries.items() if there]


register(FOLDER, _remove_folder)
