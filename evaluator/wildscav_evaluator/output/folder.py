"""The output folder of an evaluation: whose it is, and what of it is kept when the evaluation goes on."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from wildscav.errors import UserError, describe
from wildscav.system.output_folders import check_folder
from wildscav_engine.record import SUFFIX
from wildscav_evaluator.output.identity import Identity, difference, read_identity, write_identity
from wildscav_evaluator.output.layout import LEDGER_FILE, LOGS, MATCHES, RECORDS, REPLAYS, RESULTS_FILE
from wildscav_evaluator.output.lock import Lock, locked
from wildscav_evaluator.submissions.submission import MANIFEST, Submission

FOLDERS = (RECORDS, REPLAYS, LOGS, MATCHES)
# What an evaluation writes for each match, and so what the next one may remove. Nothing else is touched.
OWN_FILES = (f"{RECORDS}/*{SUFFIX}", f"{REPLAYS}/*.rrd", f"{LOGS}/*.log", f"{MATCHES}/*.json")
# What is left of a file whose writer was killed.
PARTS = (".*.part", *(f"{folder}/.*.part" for folder in FOLDERS))


@contextmanager
def output_folder(out: Path, identity: Identity, *, fresh: bool = False) -> Iterator[Lock]:
    """Make an output folder, see that it is this evaluation's, and hold it while it runs.

    Args:
        out: The folder.
        identity: The evaluation that is to be written there, or to go on.
        fresh: Whether what another evaluation left there is removed.

    Raises:
        UserError: The folder cannot be made, or belongs to another evaluation, or one is writing to it.
    """
    _make(out)
    with locked(out) as lock:
        if fresh:
            # The results first, and the identity last: killed in between, this can be done again.
            (out / RESULTS_FILE).unlink(missing_ok=True)
            (out / LEDGER_FILE).unlink(missing_ok=True)
            keep_only(out, ())
        else:
            _check_same(out, identity)
        for name in FOLDERS:  # not before: a folder that is refused is left as it is
            _make(out / name)
        try:
            write_identity(identity, out)
        except OSError as error:
            raise UserError(f"nothing can be kept in the output folder: {describe(error)}") from error
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
                f"{out} holds an evaluation that does not say which one it is: name another --out, or begin "
                f"anew with --fresh, which removes it",
                exit_code=2,
            )
    elif other := difference(old, identity):
        raise UserError(
            f"{out} holds another evaluation: {other}. To keep it, name another --out, or none; --fresh "
            "removes it and evaluates anew",
            exit_code=2,
        )


def keep_only(out: Path, stems: Iterable[str]) -> None:
    """Remove every file of a match but those of the matches named, and what killed writers left behind.

    Args:
        out: The output folder.
        stems: What the files of the matches to keep are called.
    """
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
    """Refuse an output folder that cannot be one, or in a submission: it would change what is evaluated.

    Raises:
        UserError: It is no folder, or it is a submission's, or in one.
    """
    check_folder("--out", out)
    target = out.resolve()
    for folder in (target, *target.parents):
        if (folder / MANIFEST).is_file() or any(folder == one.folder for one in submissions):
            where = "is" if folder == target else "is in"
            raise UserError(
                f"--out {out} {where} the folder of a submission: name a folder outside of it", exit_code=2
            )
