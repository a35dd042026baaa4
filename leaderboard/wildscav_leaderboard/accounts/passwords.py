"""Passwords, which people choose, and tokens, cookies and keys, which nobody can guess.

Passwords are stored as argon2 hashes. Checking one takes a while on purpose, so never in a transaction. The
others are shown once and stored as their SHA-256: they have 256 random bits, so a fast hash is enough.
"""

import hashlib
import secrets
from functools import cache

from pwdlib import PasswordHash
from pwdlib.exceptions import UnknownHashError
from pwdlib.hashers.argon2 import Argon2Hasher

from wildscav_leaderboard.seasons.refusals import InvalidError

SHORTEST, LONGEST = 10, 200  # characters


@cache
def _hasher() -> PasswordHash:
    return PasswordHash((Argon2Hasher(),))


@cache
def _nobody() -> str:
    """Return the hash that is checked for an unknown name, so that its answer takes as long as others."""
    return _hasher().hash("nobody's password")


def hashed(password: str) -> str:
    """Return the hash of a new password.

    Raises:
        InvalidError: It is too short or too long.
    """
    if not SHORTEST <= len(password) <= LONGEST:
        raise InvalidError(f"a password must have {SHORTEST} to {LONGEST} characters, not {len(password)}")
    return _hasher().hash(password)


def new_password() -> str:
    """Return a new password that nobody can guess."""
    return secrets.token_urlsafe(15)


def matches(password: str, stored: str | None) -> bool:
    """Return whether a password is the one whose hash is stored; it never is if None is stored."""
    if len(password) > LONGEST:
        return False
    try:
        right = _hasher().verify(password, stored or _nobody())
    except UnknownHashError:
        return False
    return right and stored is not None


TOKEN, INVITATION, TEAM_KEY = "wildscav_", "invite_", "team_"


def new_key(prefix: str = "") -> str:
    """Return a new text of 256 random bits."""
    return f"{prefix}{secrets.token_urlsafe(32)}"


def digest_of(key: str) -> str:
    """Return what is stored of a key, 64 hexadecimal digits."""
    return hashlib.sha256(key.encode("utf-8", "surrogatepass")).hexdigest()
