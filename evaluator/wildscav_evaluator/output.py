"""The output folder of an evaluation."""

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from wildscav.errors import UserError
from wildscav_engine.record import SUFFIX
from wildscav_evaluator.jobs import LOGS, RECORDS, REPLAYS
from wildscav_evaluator.results import RESULTS_FILE

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
    with (out / LOCK).open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise UserError(
                f"another evaluation is writing to {out}: wait for it, or name another --out"
            ) from error
        for pattern in OWN_FILES:
            for path in out.glob(pattern):
                path.unlink()
        yield
