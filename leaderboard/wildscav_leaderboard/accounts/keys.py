"""Tokens, cookies and keys: texts that nobody can guess. They are shown once and stored as their SHA-256.

A slow hash protects passwords, which can be guessed. These have 256 random bits, so a fast one is enough.
"""

import hashlib
import secrets

TOKEN, INVITATION, TEAM_KEY = "wildscav_", "invite_", "team_"


def new_key(prefix: str = "") -> str:
    """Return a new text of 256 random bits."""
    return f"{prefix}{secrets.token_urlsafe(32)}"


def digest_of(key: str) -> str:
    """Return what is stored of a key, 64 hexadecimal digits."""
    return hashlib.sha256(key.encode("utf-8", "surrogatepass")).hexdigest()
