"""The entries of a ledger: one line for each event, each an ``Entry``.

A line is canonical JSON (RFC 8785) with escapes (a backslash, ``u`` and four digits) for everything that is
not printable ASCII, so that no agent's text can control the terminal of a person who views the file. The
signature is Ed25519 (RFC 8032), in hexadecimal digits, of the bytes ``wildscav ledger entry 1``, a line feed,
and the canonical JSON of the entry without its signature, before the escapes.
"""

import json
from hashlib import sha256
from typing import Annotated, Any, Literal

import rfc8785
from pydantic import Field

from wildscav.terminal.console import ascii_json
from wildscav_evaluator.output.identity import Identity
from wildscav_evaluator.output.json_files import FileModel, WithOptionalFields
from wildscav_evaluator.output.results import MatchRow, MatchTiming, Summary

CONTEXT = b"wildscav ledger entry 1\n"  # prefix of signed bytes; no other message has it


class Opened(FileModel):
    """The evaluation began. This is always the first entry, and no other."""

    kind: Literal["opened"] = "opened"
    identity: Identity


class Resumed(FileModel):
    """The evaluation was continued after it had ended or was killed."""

    kind: Literal["resumed"] = "resumed"


class MatchStarted(FileModel):
    """A match began, or began again. A match that never ended was interrupted."""

    kind: Literal["begun"] = "begun"
    match: str  # the stem of its files' names


class AttemptFailed(FileModel):
    """The platform broke a match, which is played again."""

    kind: Literal["broke"] = "broke"
    match: str
    reason: str  # in one line


class MatchEnded(WithOptionalFields):
    """A match ended, or the platform gave it up."""

    omitted = ("exchanges",)

    kind: Literal["ended"] = "ended"
    match: str
    record: str | None  # SHA-256 of the record's file; None if the match was given up
    exchanges: str | None = None  # SHA-256 of the file of what agents asked a model; omitted without one
    row: MatchRow  # without its replay, which may be rendered later
    timing: MatchTiming | None


class Score(FileModel):
    """The score of a submission on a track."""

    submission: str
    track: str
    metric: str  # the one that ranks
    summary: Summary | None  # None if no match was played
    matches: int
    faults: int  # matches in which something went wrong


class Closed(FileModel):
    """The evaluation was completed and has results."""

    kind: Literal["closed"] = "closed"
    results: str  # SHA-256 of results.json
    scores: tuple[Score, ...]


Fact = Annotated[
    Opened | Resumed | MatchStarted | AttemptFailed | MatchEnded | Closed, Field(discriminator="kind")
]


class Entry(FileModel):
    """One line of a ledger."""

    number: int  # from 0
    previous: str | None  # SHA-256 of the previous line without its line break; None in the first
    at: str  # ISO 8601, UTC
    fact: Fact
    signature: str | None  # of the rest of the line; None in an unsigned ledger

    @property
    def signed(self) -> bytes:
        """The bytes that the signature covers."""
        return CONTEXT + canonical(self.model_dump(mode="json", exclude={"signature"}))

    @property
    def line(self) -> bytes:
        """The line, without its line break."""
        return in_ascii(canonical(self.model_dump(mode="json")))


def canonical(value: Any) -> bytes:
    """Return a value as canonical JSON, which is unique."""
    return rfc8785.dumps(value)


def in_ascii(document: bytes) -> bytes:
    """Return a JSON document with escapes for everything that is not printable ASCII."""
    return ascii_json(document.decode()).encode("ascii")


def is_canonical(line: bytes) -> bool:
    """Return whether a line is in the canonical form of its content."""
    try:
        # Parsed as floats, so that large numbers, which are written without a point, keep their form.
        return in_ascii(canonical(json.loads(line, parse_int=float))) == line
    except (ValueError, RecursionError):
        return False


def digest_of_line(line: bytes) -> str:
    """Return the digest by which the next entry refers to a line, 64 hexadecimal digits."""
    return sha256(line).hexdigest()
