"""What a process makes that should not outlive it, and how the next one removes it if the process was killed.

Each process that makes temporary things has one folder for them. In it is a file that the process keeps
locked (flock) as long as it lives. The kernel gives the lock back however the process ends, and sees every
process of the machine, whatever its user, container or process namespace. So an owner whose lock can be taken
is dead, and a live one is never mistaken for a dead one, as could happen with process numbers, which are used
again.

What lies elsewhere (control groups, containers) is entered in a list in that folder before it is made.
Whoever finds the folder of a dead owner removes what is on the list, then the folder.
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
SHORT_PLACE = Path("/tmp")  # noqa: S108 - where temporary files are in a path too long for sockets
LONGEST_PLACE = 40  # bytes of that path: systems allow 104 for a socket's
GRACE = 60.0  # s in which a new folder gets its lock, unless its maker was killed

Undo = Callable[[str], None]
_undo: dict[str, Undo] = {}
_lock = threading.Lock()


def register(kind: str, undo: Undo) -> None:
    """Say how one kind of thing outside of owners' folders is removed.

    Args:
        kind: Its name in lists.
        undo: Removes one that was entered, by the text that was entered; does nothing if it is gone already.
            An ``OSError`` or ``RuntimeError`` means that it may still be there: it is tried again later.
    """
    _undo[kind] = undo


def own_folder() -> Path:
    """Return this process's folder for temporary things, made when it is first asked for.

    It is removed when the process ends, or by ``sweep`` in another process if this one was killed.
    """
    with _lock:
        return _folder_of(os.getpid())


def owner() -> str:
    """Return the name of this process as an owner, which no other process has ever had."""
    return own_folder().name.removeprefix(PREFIX)


@contextlib.contextmanager
def temporary_folder(prefix: str) -> Iterator[Path]:
    """Make a folder in this process's own one, and remove it at the end."""
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
    enter(FOLDER, str(folder))
    try:
        folder.mkdir()
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        if not folder.exists():
            cross_out(FOLDER, str(folder))


def _remove_folder(folder: str) -> None:
    with contextlib.suppress(FileNotFoundError):
        shutil.rmtree(folder)


def enter(kind: str, what: str) -> None:
    """Enter in this process's list something that it is about to make outside of its folder.

    Args:
        kind: As it was registered.
        what: Which one, as its ``undo`` reads it.
    """
    _write(kind, what, there=True)


def cross_out(kind: str, what: str) -> None:
    """Note in this process's list that something entered there is gone."""
    _write(kind, what, there=False)


def _write(kind: str, what: str, *, there: bool) -> None:
    line = json.dumps([kind, what, there]) + "\n"
    with (own_folder() / LIST).open("a", encoding="utf-8") as file:
        file.write(line)


def sweep() -> None:
    """Remove everything that dead owners of this user have left on this machine.

    It takes a millisecond if there is nothing. What cannot be removed now stays for the next time.
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
    """Make the folder of a process: one for every process, and another one after a fork."""
    sweep()
    while True:
        new = Path(tempfile.mkdtemp(prefix=NEW, dir=_place()))
        descriptor = os.open(new / LOCK, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        os.write(descriptor, f"{process}\n".encode())
        folder = new.with_name(PREFIX + new.name.removeprefix(NEW))
        try:
            # Only now may others see it: a folder that they see has its lock.
            new.rename(folder)
        except OSError:  # this process was stopped for so long that it was taken for dead
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
    """Return where folders are made: where the system has temporary files, if sockets can be there."""
    place = Path(tempfile.gettempdir())
    return place if len(bytes(place)) <= LONGEST_PLACE or not SHORT_PLACE.is_dir() else SHORT_PLACE


def _places() -> list[Path]:
    return [place for place in {Path(tempfile.gettempdir()), SHORT_PLACE} if place.is_dir()]


def _is_own(path: Path) -> bool:
    """Return whether a path is this user's: what others put there is not for us to follow."""
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
    """Remove what is on an owner's list, then its folder, the lock last.

    Raises:
        OSError: Something could not be removed; the list still has it.
        RuntimeError: The same.
    """
    for kind, what in _entries(folder / LIST):
        if kind not in _undo:
            raise RuntimeError(f"nobody here knows how to remove a {kind}")
        _undo[kind](what)
    for entry in list(folder.iterdir()):
        if entry.name == LOCK:
            continue
        if entry.is_dir() and not entry.is_symlink():
            shutil.rmtree(entry)
        else:
            entry.unlink()
    # A name under which its remains are found even without the lock.
    remains = folder.rename(folder.with_name(NEW + folder.name.removeprefix(PREFIX)))
    (remains / LOCK).unlink()
    remains.rmdir()


def _entries(path: Path) -> list[tuple[str, str]]:
    """Return what a list has that was not crossed out; lines that are damaged are passed over.

    A last line that was cut off was not acted upon.
    """
    entries: dict[tuple[str, str], bool] = {}
    with contextlib.suppress(FileNotFoundError):
        for line in path.read_text("utf-8").splitlines():
            with contextlib.suppress(ValueError, TypeError):
                kind, what, there = json.loads(line)
                entries[kind, what] = there
    return [entry for entry, there in entries.items() if there]


register(FOLDER, _remove_folder)
