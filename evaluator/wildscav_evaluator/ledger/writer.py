"""Writing the ledger of an evaluation while it is played, possibly over several runs."""

import os
from collections.abc import Sequence
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path

from wildscav.errors import UserError, describe
from wildscav_engine.record import FILE_LIMIT, SUFFIX, RecordError
from wildscav_engine.record.format import decode
from wildscav_engine.storage.files import read_limited
from wildscav_evaluator.ledger.entries import (
    AttemptFailed,
    Closed,
    Entry,
    Fact,
    MatchEnded,
    MatchStarted,
    Opened,
    Resumed,
    Score,
    digest_of_line,
)
from wildscav_evaluator.ledger.keys import SigningKey
from wildscav_evaluator.ledger.ledger import Ledger, LedgerError, parse_ledger, read_lines, sha256_of
from wildscav_evaluator.matches.jobs import Job, JobResult
from wildscav_evaluator.output.identity import Identity
from wildscav_evaluator.output.layout import LEDGER_FILE, RECORDS
from wildscav_evaluator.output.results import MatchRow, Results

INSTEAD = "name another --out, or start over with --fresh"


class LedgerWriter:
    """Appends to the ledger of an evaluation. Its creator must hold the lock of the output folder.

    Each entry is flushed to disk before anything else happens. Half an entry at the end of an existing ledger
    was left by a writer that was killed; it is cut off. UserError if it was changed or belongs to another
    evaluation, or if there are records without a ledger.
    """

    def __init__(self, out: Path, identity: Identity, key: SigningKey | None) -> None:
        self._out, self._key = out, key
        self._path = out / LEDGER_FILE
        self._number = 0
        self.head = ""  # SHA-256 of the last line, which identifies the whole ledger
        self.played: dict[str, MatchEnded] = {}  # the matches that have a result
        self.closed: Closed | None = None  # the last entry, if it has the results
        ledger = self._read_existing(identity)
        self._resumed = ledger is None
        if ledger is None:
            if any((out / RECORDS).glob(f"*{SUFFIX}")):
                raise _changed(f"{out} has matches that were played, but no {LEDGER_FILE}")
            self._append(Opened(identity=identity))
        else:
            self._number, self.head = len(ledger.entries), ledger.head
            self.played, self.closed = ledger.played, ledger.closed

    def _read_existing(self, identity: Identity) -> Ledger | None:
        """Return the existing ledger, truncated to its last complete line; None if there is none."""
        try:
            content = read_lines(self._path)
        except FileNotFoundError:
            return None
        except LedgerError as error:  # it is too large, or was changed
            raise UserError(f"{error}: it cannot be continued; {INSTEAD}", exit_code=2) from error
        whole = content[: content.rfind(b"\n") + 1]
        if len(whole) < len(content):
            os.truncate(self._path, len(whole))
        if not whole:
            return None
        try:
            ledger = parse_ledger(self._path, whole)
        except LedgerError as error:
            raise _changed(str(error)) from error
        if ledger.identity != identity:
            raise _changed(f"{self._path} is of another evaluation")
        return ledger

    def kept(self, jobs: Sequence[Job]) -> list[JobResult]:
        """Return the results of the jobs that earlier runs played, after checking each against its record.

        UserError if a match, its record or its entry was changed.
        """
        if unknown := self.played.keys() - {job.stem for job in jobs}:
            raise _changed(f"{self._path} has the match {min(unknown)}, which is not of this evaluation")
        return [_kept(job, self.played[job.stem]) for job in jobs if job.stem in self.played]

    def begin(self, match: str) -> None:
        """Enter that a match begins, unless it was played already and only its replay is missing."""
        if match not in self.played:
            self._append(MatchStarted(match=match))

    def broke(self, match: str, reason: str) -> None:
        """Enter that the platform broke a match, which will be played again."""
        if match not in self.played:
            self._append(AttemptFailed(match=match, reason=reason))

    def end(self, result: JobResult) -> None:
        """Enter how a match ended."""
        job, row = result.job, result.row.model_copy(update={"replay": None})
        if job.stem in self.played:
            return
        record = None if row.record is None else sha256_of(job.out / row.record)
        asked = job.out / job.exchanges
        exchanges = sha256_of(asked) if job.model is not None and asked.exists() else None
        ended = MatchEnded(match=job.stem, record=record, exchanges=exchanges, row=row, timing=result.timing)
        self._append(ended)
        if record is not None:
            self.played[job.stem] = ended

    def close(self, results: Results, path: Path) -> None:
        """Enter the results of the evaluation, unless the last entry has the same results."""
        scores = tuple(
            Score.about(one, metric=one.metrics[0].name, summary=one.score, matches=len(one.matches))
            for one in results.evaluations
        )
        closed = Closed(results=sha256_of(path), scores=scores)
        if closed != self.closed:
            self._append(closed)
            self.closed = closed

    def _append(self, fact: Fact) -> None:
        if not self._resumed:
            self._resumed = True
            self._append(Resumed())
        self.closed = None
        at = datetime.now(UTC).isoformat(timespec="milliseconds")
        entry = Entry(number=self._number, previous=self.head or None, at=at, fact=fact, signature=None)
        if self._key is not None:
            entry = entry.model_copy(update={"signature": self._key.sign(entry.signed)})
        line = entry.line
        try:
            with self._path.open("ab") as writer:
                writer.write(line + b"\n")
                writer.flush()
                os.fsync(writer.fileno())
        except OSError as error:
            raise UserError(f"the ledger {self._path} cannot be written: {error.strerror}") from error
        self._number, self.head = self._number + 1, digest_of_line(line)


def _kept(job: Job, ended: MatchEnded) -> JobResult:
    """Return the result of a job from its entry, after checking that its record supports it."""
    path, row = job.out / job.record, ended.row
    try:
        content = read_limited(path, FILE_LIMIT)
        if sha256(content).hexdigest() != ended.record:
            raise _changed(f"{path} is not the record that is in the ledger")
        seats = decode(content).result.seats
    except OSError as error:
        raise _changed(f"the record of {job.stem} cannot be read: {describe(error)}") from error
    except RecordError as error:
        raise _changed(f"{path}: {error}") from error
    for seat in row.seats:
        if not seat.seat < len(seats) or seat.metrics != seats[seat.seat].metrics:
            raise _changed(f"the metrics of {job.stem} in the ledger are not those of its record")
    if not row.seats or MatchRow.of(job.index, row.seats, job.record) != row:
        raise _changed(f"the ledger's summary of {job.stem} is not that of its seats")
    if job.replay and (job.out / job.replay_path).exists():
        row = row.model_copy(update={"replay": job.replay_path})
    return JobResult(job, row, ended.timing)


def _changed(why: str) -> UserError:
    return UserError(f"{why}: the matches played so far cannot be trusted; {INSTEAD}", exit_code=2)
