"""The journal of an evaluation: a file for every match that was played to its end and kept.

Such a file appears whole, after the match's record, and names that record by its content. So whatever moment
an evaluation is killed at, a match is either in the journal, together with its record, or was never played.
"""

from hashlib import blake2b
from pathlib import Path
from typing import Literal

from wildscav_engine.record import FILE_LIMIT
from wildscav_engine.storage.files import read_limited
from wildscav_evaluator.output.json_files import FileModel, FileModelError
from wildscav_evaluator.output.layout import MATCHES
from wildscav_evaluator.output.results import MatchRow, MatchTiming


class Entry(FileModel):
    """One match of the journal."""

    format: Literal[1] = 1
    evaluation: str  # digest of the evaluation's identity
    match: str  # which match it is, as its files are called
    record: str  # digest of the record's file
    row: MatchRow  # without its replay, which may be rendered later
    timing: MatchTiming


def entry_path(out: Path, match: str) -> Path:
    """Return where a match's entry is."""
    return out / MATCHES / f"{match}.json"


def write_entry(out: Path, evaluation: str, match: str, row: MatchRow, timing: MatchTiming) -> None:
    """Enter a match whose record is written.

    Args:
        out: The output folder.
        evaluation: Digest of the evaluation's identity.
        match: What its files are called.
        row: How it went.
        timing: How long it took.

    Raises:
        OSError: It cannot be written.
    """
    digest = file_digest(out / str(row.record))
    entry = Entry(evaluation=evaluation, match=match, record=digest, row=row, timing=timing)
    entry.write(entry_path(out, match))


def read_entry(out: Path, evaluation: str, match: str) -> Entry | None:
    """Return a match of the journal, if it was played in this evaluation and its record is as it was."""
    try:
        entry = Entry.read(entry_path(out, match))
        if (entry.evaluation, entry.match) != (evaluation, match):
            return None
        return entry if file_digest(out / str(entry.row.record)) == entry.record else None
    except (OSError, FileModelError):
        return None


def file_digest(path: Path) -> str:
    """Return a digest of a file's content, 32 hexadecimal digits.

    Raises:
        OSError: It cannot be read.
    """
    return blake2b(read_limited(path, FILE_LIMIT), digest_size=16).hexdigest()
