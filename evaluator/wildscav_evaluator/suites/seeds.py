"""The seed of a suite: public, or hidden behind a commitment until it is opened.

A secret is a small file that nobody can guess. Its commitment is the SHA-256 of the file, as ``sha256sum``
prints it. Published beforehand, it binds the organizer to this seed without revealing it. To open a secret is
to publish the file.
"""

import hashlib
import hmac
import secrets
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from wildscav.errors import UserError
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.storage.files import read_limited
from wildscav_evaluator.seats import submission_seats

SHORTEST, LONGEST = 32, 4096  # bytes of a secret
LARGEST = 1 << 20  # bytes of a file that is read


@dataclass(frozen=True)
class SuiteSeed:
    """The seed that determines the matches of a suite."""

    value: int
    commitment: str | None = None  # 64 hexadecimal digits; None for a public seed

    @property
    def label(self) -> str:
        """The public part of the seed."""
        return label(None if self.commitment else self.value, self.commitment)

    def private(self, spec: MatchSpec, digests: Sequence[str]) -> tuple[int, ...]:
        """Return the private seeds that the agents in a match are told, 63 bits each, in the order of seats.

        Each depends on the submission, so what one agent noted with its seed is of no use to the next, and
        reveals nothing about this seed.
        """
        key, match = str(self.value).encode(), spec.model_dump_json()
        return tuple(
            int.from_bytes(hmac.digest(key, f"{seat} {digest} {match}".encode(), "sha256")[:8], "big") >> 1
            for seat, digest in zip(submission_seats(spec.seats), digests, strict=True)
        )


def label(seed: int | None, commitment: str | None) -> str:
    """Return the public part of a seed: the seed itself, or the beginning of its commitment."""
    if commitment is not None:
        return f"hidden:{commitment[:12]}"
    return "unknown" if seed is None else str(seed)


def read_secret(path: Path) -> SuiteSeed:
    """Return the seed that a secret determines; UserError if the file cannot be read, or can be no secret."""
    try:
        content = read_limited(path, LARGEST)
    except OSError as error:
        raise UserError(
            f"the secret {path} cannot be read: {error.strerror}; "
            f"`wildscav season secret new {path}` makes one",
            2,
        ) from error
    if not SHORTEST <= len(content) <= LONGEST:
        raise UserError(
            f"{path} has {len(content)} bytes, a secret must have {SHORTEST} to {LONGEST}, all random: "
            "`wildscav season secret new FILE` makes one",
            exit_code=2,
        )
    return seed_of(content)


def seed_of(content: bytes) -> SuiteSeed:
    """Return the seed that the content of a secret determines."""
    # Not the commitment itself, which is public.
    value = hashlib.sha256(b"wildscav suite seed\0" + content).digest()
    return SuiteSeed(int.from_bytes(value, "big"), commitment_of(content))


def commitment_of(content: bytes) -> str:
    """Return the commitment to a secret, which does not reveal it, 64 hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


def new_secret() -> bytes:
    """Return a secret that nobody can guess: a line of 256 random bits."""
    return f"wildscav-secret-1 {secrets.token_hex(32)}\n".encode()
