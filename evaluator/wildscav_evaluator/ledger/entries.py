"""What stands in a ledger: a line for each thing that happened.

A line is canonical JSON (RFC 8785) with escapes for all that is not printable ASCII, so that no agent's text
can steer the terminal of whoever looks at the file. What is signed is the canonical JSON itself.
"""

import json
from hashlib import sha256
from typing import Annotated, Any, Literal

import rfc8785
from pydantic import Field

from wildscav.terminal.console import ascii_json
from wildscav_evaluator.output.identity import Identity
from wildscav_evaluator.output.json_files import FileModel
from wildscav_evaluator.output.results import MatchRow, MatchTiming, Summary

CONTEXT = b"wildscav ledger entry 1\n"  # stands before what is signed: no signature is good for anything else


class Opened(FileModel):
    """The evaluation began. Always the first entry, and only that."""

    kind: Literal["opened"] = "opened"
    identity: Identity


class Resumed(FileModel):
    """The evaluation went on after it had ended or was killed."""

    kind: Literal["resumed"] = "resumed"


class Begun(FileModel):
    """A match was begun, or begun again. One that never ended was interrupted."""

    kind: Literal["begun"] = "begun"
    match: str  # as its files are called


class Broke(FileModel):
    """The platform broke a match, which is played again."""

    kind: Literal["broke"] = "broke"
    match: str
    reason: str  # in a line


class Ended(FileModel):
    """A match came to its end, or the platform gave it up."""

    kind: Literal["ended"] = "ended"
    match: str
    record: str | None  # SHA-256 of the record's file; none if the match was given up
    row: MatchRow  # without its replay, which may be rendered later
    timing: MatchTiming | None


class Score(FileModel):
    """What a submission came to on a track."""

    submission: str
    track: str
    metric: str  # the one that ranks
    summary: Summary | None  # none if no match was played
    matches: int
    faults: int  # matches in which something went wrong


class Closed(FileModel):
    """The evaluation came to its results."""

    kind: Literal["closed"] = "closed"
    results: str  # SHA-256 of results.json
    scores: tuple[Score, ...]


Fact = Annotated[Opened | Resumed | Begun | Broke | Ended | Closed, Field(discriminator="kind")]


class Entry(FileModel):
    """One line of a ledger."""

    number: int  # from 0
    previous: str | None  # SHA-256 of the line before, without its end; none of the first
    at: str  # ISO 8601, UTC
    fact: Fact
    signature: str | None  # of everything else in the line; none in a ledger that nobody signs

    @property
    def signed(self) -> bytes:
        """What the signature is of."""
        return CONTEXT + canonical(self.model_dump(mode="json", exclude={"signature"}))

    @property
    def line(self) -> bytes:
        """The line, without its end."""
        return in_ascii(canonical(self.model_dump(mode="json")))


def canonical(value: Any) -> bytes:
    """Return the one form in canonical JSON that a value has."""
    return rfc8785.dumps(value)


def in_ascii(document: bytes) -> bytes:
    """Return a JSON document with escapes for all that is not printable ASCII."""
    return ascii_json(document.decode()).encode("ascii")


def is_canonical(line: bytes) -> bool:
    """Return whether some bytes are the one form that a line with its content has."""
    try:
        # As floats, so that large ones, which are written without a point, come out as they were.
        return in_ascii(canonical(json.loads(line, parse_int=float))) == line
    except (ValueError, RecursionError):
        return False


def digest_of_line(line: bytes) -> str:
    """Return what the next entry calls a line, 64 hexadecimal digits."""
    return sha256(line).hexdigest()
