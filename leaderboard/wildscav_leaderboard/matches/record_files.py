"""The digest by which a season knows the record of a match."""

from hashlib import blake2b


def record_digest(content: bytes) -> str:
    """Return the digest of a record's file: BLAKE2b, 32 hexadecimal digits."""
    return blake2b(content, digest_size=16).hexdigest()
