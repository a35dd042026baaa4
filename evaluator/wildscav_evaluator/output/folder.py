"""The output folder of an evaluation: checking whose it is, and what is kept when it is continued."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from wildscav.errors import UserError, describe
from wildscav.sdk.submission_folder import MANIFEST
from wildscav.system.output_folders import check_folder
from wildscav_engine.record import SUFFIX
from wildscav_evaluator.output.identity import Identity, difference, read_identity, write_identity
from wildscav_evaluator.output.layout import (
    COMPARISON_FILE,
    EXCHANGES,
    JOURNAL,
    LEDGER_FILE,
    LOGS,
    OPENED_FILE,
    RECORDS,
    REPLAYS,
    RESULTS_FILE,
    STANDINGS_PICTURE,
    SUITE_FILE,
    TOURNAMENT_FILE,
)
from wildscav_evaluator.output.lock import Lock, locked
from wildscav_evaluator.submissions.submission import Submission

FOLDERS = (RECORDS, REPLAYS, LOGS)
# The files about all matches, besides the identity; a fresh evaluation removes them.
OWN_DOCUMENTS = (
    *(RESULTS_FILE, LEDGER_FILE, COMPARISON_FILE, TOURNAMENT_FILE),
    *(STANDINGS_PICTURE, SUITE_FILE, OPENED_FILE),
)
# The files that an evaluation writes for each match. The next one may remove these and no others.
OWN_FILES = (
    *(f"{RECORDS}/*{SUFFIX}", f"{REPLAYS}/*.rrd", f"{LOGS}/*.log", f"{JOURNAL}/*.json"),
    f"{EXCHANGES}/*.jsonl.gz",
)
# Partial files, which remain if their writer was killed.
PARTS = (".*.part", *(f"{folder}/.*.part" for folder in (*FOLDERS, JOURNAL)))


@contextmanager
def output_folder(out: Path, identity: Identity, *, fresh: bool = False) -> Iterator[Lock]:
    """Make an output folder, check that it belongs to this evaluation, and lock it while the block lasts.

    A ``fresh`` one removes what an earlier evaluation left there. UserError if the folder cannot be made,
    belongs to another evaluation, or one is writing to it.
    """
    _make(out)
    with locked(out) as lock:
        if fresh:
            # The results first and the identity last, so that this can be repeated if it is interrupted.
            for name in OWN_DOCUMENTS:
                (out / name).unlink(missing_ok=True)
            keep_only(out, ())
        else:
            _check_same(out, identity)
        for name in FOLDERS:  # only now, so that a refused folder stays unchanged
            _make(out / name)
        try:
            write_identity(identity, out)
        except OSError as error:
            raise UserError(f"the output folder cannot be written: {describe(error)}") from error
        yield lock


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"cannot make the output folder {error.filename}: {error.strerror}") from error


def _check_same(out: Path, identity: Identity) -> None:
    """Refuse a folder with another evaluation in it."""
    old = read_identity(out)
    if old is None:
        if (out / RESULTS_FILE).exists() or any(True for _ in _own_files(out)):
            raise UserError(
                f"{out} holds an evaluation that cannot be identified: name another --out, or start "
                "over with --fresh, which removes it",
                exit_code=2,
            )
    elif other := difference(old, identity):
        raise UserError(
            f"{out} holds another evaluation: {other}. To keep it, name another --out or omit it; --fresh "
            "removes it and starts over",
            exit_code=2,
        )


def keep_only(out: Path, stems: Iterable[str]) -> None:
    """Remove the files of all matches except those with some stems, and the partial files of dead writers."""
    kept = set(stems)
    for path in _own_files(out):
        if path.name.partition(".")[0] not in kept:
            path.unlink()
    for pattern in PARTS:
        for path in out.glob(pattern):
            path.unlink()


def _own_files(out: Path) -> Iterator[Path]:
    for pattern in OWN_FILES:
        yield from list(out.glob(pattern))


def check_out(out: Path, submissions: Iterable[Submission]) -> None:
    """Refuse an invalid output folder, or one in a submission, because it would change what is evaluated."""
    check_folder("--out", out)
    target = out.resolve()
    for folder in (target, *target.parents):
        if (folder / MANIFEST).is_file() or any(folder == one.folder for one in submissions):
            where = "is" if folder == target else "is in"
            raise UserError(
                f"--out {out} {where} the folder of a submission: name a folder outside of it", exit_code=2
            )
