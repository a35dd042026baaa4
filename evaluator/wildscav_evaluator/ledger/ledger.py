"""Reading a ledger, and verifying its chain and its signatures.

Each entry names the previous one by its digest and has its own signature. So an evaluation may be killed at
any moment and continued, and yet nothing in between can be changed, removed or inserted.
"""

import io
from collections.abc import Iterator
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from wildscav.errors import UserError, describe
from wildscav_engine.record import FILE_LIMIT
from wildscav_engine.storage.files import read_limited
from wildscav_evaluator.ledger.entries import (
    AttemptFailed,
    Closed,
    Entry,
    Fact,
    MatchEnded,
    MatchStarted,
    Opened,
    digest_of_line,
    is_canonical,
)
from wildscav_evaluator.ledger.keys import is_signed
from wildscav_evaluator.output.identity import Identity
from wildscav_evaluator.output.json_files import LARGEST, FileModelError, read_after_trial
from wildscav_evaluator.output.layout import LEDGER_FILE


class LedgerError(UserError):
    """A ledger cannot be read, or its chain or one of its signatures is broken."""


@dataclass(frozen=True)
class Ledger:
    """A ledger with an intact chain, and with valid signatures if it is signed."""

    entries: tuple[Entry, ...]  # at least one
    head: str  # SHA-256 of the last line, which identifies the whole ledger

    @property
    def identity(self) -> Identity:
        """The identity of the evaluation."""
        fact = self.entries[0].fact
        if not isinstance(fact, Opened):
            raise TypeError("the first entry of a ledger has its identity")
        return fact.identity

    @property
    def key(self) -> str | None:
        """The public key of its signatures; None if it is not signed."""
        return self.identity.key

    @property
    def closed(self) -> Closed | None:
        """The entry with the evaluation's results; None if it was not completed."""
        fact = self.entries[-1].fact
        return fact if isinstance(fact, Closed) else None

    @property
    def ended(self) -> dict[str, list[MatchEnded]]:
        """The entries of each match's ends, in order, by the stem of its files' names."""
        by_match: dict[str, list[MatchEnded]] = {}
        for entry in self.entries:
            if isinstance(entry.fact, MatchEnded):
                by_match.setdefault(entry.fact.match, []).append(entry.fact)
        return by_match

    @property
    def played(self) -> dict[str, MatchEnded]:
        """The matches that have a result, by the stem of their files' names."""
        return {match: times[-1] for match, times in self.ended.items() if times[-1].record is not None}

    @property
    def interrupted(self) -> dict[str, int]:
        """How often each match was restarted after an interruption that was not the platform's fault."""
        last: dict[str, Fact] = {}
        left: dict[str, int] = {}
        for fact in (entry.fact for entry in self.entries):
            if isinstance(fact, MatchStarted | AttemptFailed | MatchEnded):
                if isinstance(fact, MatchStarted) and isinstance(last.get(fact.match), MatchStarted):
                    left[fact.match] = left.get(fact.match, 0) + 1
                last[fact.match] = fact
        return left


def read_ledger(out: Path) -> Ledger | None:
    """Read the ledger of an output folder; return None if it has none.

    LedgerError if it cannot be read, or was changed; the message names the first line that shows this.
    """
    path = out / LEDGER_FILE
    try:
        content = read_lines(path)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise LedgerError(f"the ledger cannot be read: {describe(error)}") from error
    if not content.endswith(b"\n"):
        raise LedgerError(f"{path} ends in the middle of a line" if content else f"{path} is empty")
    return parse_ledger(path, content)


def read_lines(path: Path) -> bytes:
    """Return the content of a ledger's file; LedgerError if its entries take too much time or memory."""
    try:
        return read_after_trial(path, f"{__name__}:try_entries")
    except FileModelError as error:
        raise LedgerError(f"{path}: {error}") from None


def parse_ledger(path: Path, content: bytes) -> Ledger:
    """Parse the content of a ledger's file, which ends with a line break; LedgerError if it is not valid."""
    entries: list[Entry] = []
    previous: str | None = None
    for number, line in enumerate(_lines(content)):
        entry = _entry(line, number, str(path))
        if not is_canonical(line):
            raise LedgerError(f"{path}, line {number + 1}: is not in canonical JSON")
        if (entry.number, entry.previous) != (number, previous):
            raise LedgerError(
                f"{path}, line {number + 1}: does not follow the previous line: an entry was changed, "
                "removed or inserted"
            )
        if isinstance(entry.fact, Opened) != (number == 0):
            raise LedgerError(f"{path}, line {number + 1}: the first entry, and no other, opens a ledger")
        entries.append(entry)
        previous = digest_of_line(line)
    ledger = Ledger(tuple(entries), previous or "")
    for entry in ledger.entries:
        _check_signature(path, entry, ledger.key)
    return ledger


def try_entries(path: str) -> None:
    """Read all entries of a file in the calling process; LedgerError if a line is none."""
    content = read_limited(Path(path), LARGEST)
    whole = content[: content.rfind(b"\n") + 1]  # a writer that was killed left half a line
    kept = [_entry(line, number, "") for number, line in enumerate(_lines(whole))]
    del kept  # all of them fit into memory at once


def _lines(content: bytes) -> Iterator[bytes]:
    return (line.removesuffix(b"\n") for line in io.BytesIO(content))


def _entry(line: bytes, number: int, place: str) -> Entry:
    try:
        return Entry.parse(line)
    except FileModelError as error:
        raise LedgerError(f"{place}, line {number + 1}: not an entry: {error}".lstrip(", ")) from None


def _check_signature(path: Path, entry: Entry, key: str | None) -> None:
    where = f"{path}, line {entry.number + 1}"
    if key is None:
        if entry.signature is not None:
            raise LedgerError(f"{where}: is signed, but the ledger names no key")
    elif entry.signature is None or not is_signed(entry.signed, entry.signature, key):
        raise LedgerError(f"{where}: its signature is not that of the key {key}: it was changed or inserted")


def check_key(ledger: Ledger | None, key: str, out: Path) -> None:
    """Check that a ledger is signed with the expected key; LedgerError if it is not."""
    if ledger is None:
        raise LedgerError(f"there is no {out / LEDGER_FILE}: nothing there is signed")
    if ledger.key is None:
        raise LedgerError(f"{out / LEDGER_FILE} is not signed, though the key {key} is expected")
    if ledger.key != key:
        raise LedgerError(f"{out / LEDGER_FILE} is signed with the key {ledger.key}, not with {key}")


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file; OSError if it is larger than any file of an evaluation."""
    return sha256(read_limited(path, FILE_LIMIT)).hexdigest()
