"""The output folder of an evaluation."""

import fcntl
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from wildscav.errors import UserError
from wildscav_engine.record import SUFFIX
from wildscav_evaluator.jobs import LOGS, RECORDS, REPLAYS
from wildscav_evaluator.results import RESULTS_FILE
from wildscav_evaluator.submission import MANIFEST, Submission

# What an evaluation writes, and so what the next one into the same folder removes. Nothing else is touched.
OWN_FILES = (
    RESULTS_FILE,
    f"{RECORDS}/*{SUFFIX}",
    f"{REPLAYS}/*.rrd",
    f"{LOGS}/*.log",
)
LOCK = ".evaluating"


@contextmanager
def output_folder(out: Path) -> Iterator[None]:
    """Make an output folder, empty it of an earlier evaluation's files, and hold it while one runs.

    Raises:
        UserError: The folder cannot be made, or another evaluation is writing to it.
    """
    try:
        for name in (RECORDS, REPLAYS, LOGS):
            (out / name).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"cannot make the output folder {error.filename}: {error.strerror}") from error
    with _locked(out):
        for pattern in OWN_FILES:
            for path in out.glob(pattern):
                path.unlink()
        yield


@contextmanager
def _locked(out: Path) -> Iterator[None]:
    """Hold the lock of a folder, and remove its file at the end."""
    path = out / LOCK
    with path.open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            _check_current(path, lock.fileno())
        except OSError as error:
            raise UserError(
                f"another evaluation is writing to {out}: wait for it, or name another --out"
            ) from error
        try:
            yield
        finally:
            # While it is still locked: nobody who comes later can hold the same file.
            path.unlink(missing_ok=True)


def _check_current(path: Path, lock: int) -> None:
    """Raise an OSError unless a lock is the file of that path.

    Whoever held it before may have removed the file after we opened and before we locked it.
    """
    if not os.path.samestat(path.stat(), os.fstat(lock)):
        raise BlockingIOError(f"{path} has been made anew")


def check_out(out: Path, submissions: Iterable[Submission]) -> None:
    """Refuse an output folder in a submission: it would change what is evaluated.

    Raises:
        UserError: It is a submission's folder, or in one.
    """
    target = out.resolve()
    for folder in (target, *target.parents):
        if (folder / MANIFEST).is_file() or any(folder == one.folder for one in submissions):
            where = "is" if folder == target else "is in"
            raise UserError(
                f"--out {out} {where} the folder of a submission: name a folder outside of it", exit_code=2
            )
