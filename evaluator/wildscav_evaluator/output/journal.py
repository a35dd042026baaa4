"""The journal of an evaluation: one file for every match that was completed.

The file is written atomically after the match's record, and holds the record's digest. So no matter when an
evaluation is killed, a match is either in the journal together with its record, or counts as not played.
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
    match: str  # the stem of its files' names
    record: str  # digest of the record's file
    row: MatchRow  # without its replay, which may be rendered later
    timing: MatchTiming


def entry_path(out: Path, match: str) -> Path:
    """Return the path of a match's entry."""
    return out / MATCHES / f"{match}.json"


def write_entry(out: Path, evaluation: str, match: str, row: MatchRow, timing: MatchTiming) -> None:
    """Enter a match whose record is written.

    Args:
        out: The output folder.
        evaluation: Digest of the evaluation's identity.
        match: The stem of its files' names.
        row: Its result.
        timing: Its timing.

    Raises:
        OSError: It cannot be written.
    """
    digest = file_digest(out / str(row.record))
    entry = Entry(evaluation=evaluation, match=match, record=digest, row=row, timing=timing)
    entry.write(entry_path(out, match))


def read_entry(out: Path, evaluation: str, match: str) -> Entry | None:
    """Return a match of the journal, if it was played in this evaluation and its record is unchanged."""
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
