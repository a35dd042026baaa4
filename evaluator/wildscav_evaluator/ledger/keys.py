"""Organizers' keys: Ed25519, the private half in a file that only its owner may read.

A private key is a PKCS #8 file in PEM, which tools such as OpenSSL can also read. A public key is written
as 64 hexadecimal digits: its 32 bytes.
"""

import os
import re
import stat
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from cryptography.exceptions import InvalidSignature, UnsupportedAlgorithm
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey, Ed25519PublicKey
from cryptography.hazmat.primitives.serialization import (
    BestAvailableEncryption,
    Encoding,
    KeySerializationEncryption,
    NoEncryption,
    PrivateFormat,
    PublicFormat,
    load_pem_private_key,
    load_pem_public_key,
)

from wildscav.errors import UserError, describe

PUBLIC = re.compile("[0-9a-f]{64}")
LONGEST = 8192  # bytes of a key's file
MAKE_ONE = "`wildscav season key new FILE` makes one"


@dataclass(frozen=True)
class SigningKey:
    """The private half of an organizer's key."""

    _key: Ed25519PrivateKey

    @property
    def public(self) -> str:
        """The public half, 64 hexadecimal digits."""
        return _digits(self._key.public_key())

    def sign(self, content: bytes) -> str:
        """Return the signature of some bytes, 128 hexadecimal digits."""
        return self._key.sign(content).hex()


def new_key(path: Path, passphrase: str | None = None) -> SigningKey:
    """Make a key and write its private half to a new file that only its owner may read.

    Without a passphrase, it is not encrypted. An existing file is never overwritten. UserError if
    there is one, or the file cannot be written, or the passphrase cannot be used.
    """
    key = Ed25519PrivateKey.generate()
    encryption: KeySerializationEncryption = NoEncryption()
    try:
        if passphrase is not None:
            encryption = BestAvailableEncryption(passphrase.encode())
        content = key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, encryption)
    except ValueError as error:  # it is empty, too long, or not text
        raise UserError(f"the passphrase cannot be used: {error}", exit_code=2) from None
    try:
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except FileExistsError as error:
        raise UserError(f"{path} exists already: a key is never overwritten", exit_code=2) from error
    except OSError as error:
        raise UserError(f"the key cannot be written: {describe(error)}", exit_code=2) from error
    try:
        with os.fdopen(descriptor, "wb") as writer:
            writer.write(content)
    except OSError as error:
        path.unlink(missing_ok=True)
        raise UserError(f"the key cannot be written: {describe(error)}") from error
    return SigningKey(key)


def read_key(path: Path, passphrase: Callable[[], str]) -> SigningKey:
    """Read the private half of a key; ``passphrase`` is called if it is encrypted.

    UserError if the file cannot be read, can be read by others, or holds no Ed25519 key.
    """
    content = _content(path, "key")
    if stat.S_IMODE(path.stat().st_mode) & 0o077:
        raise UserError(f"{path} can be read by others: `chmod 600 {path}` makes it private", exit_code=2)
    try:
        key = _private(content, None)
    except TypeError:  # it is encrypted
        try:
            key = _private(content, passphrase().encode())
        except ValueError as error:
            raise UserError(f"that is not the passphrase of {path}", exit_code=2) from error
    except (ValueError, UnsupportedAlgorithm) as error:
        raise UserError(f"{path} is not a private key in PEM: {MAKE_ONE}", exit_code=2) from error
    if not isinstance(key, Ed25519PrivateKey):
        raise UserError(f"{path} is not an Ed25519 key: {MAKE_ONE}", exit_code=2)
    return SigningKey(key)


def _private(content: bytes, passphrase: bytes | None) -> object:
    return load_pem_private_key(content, passphrase)


def read_public(text: str) -> str:
    """Return a public key, 64 hexadecimal digits: from these, or a file that holds them or the key in PEM."""
    if PUBLIC.fullmatch(text.lower()):
        return _checked(text.lower(), text)
    content = _content(Path(text), "public key")
    if b"PRIVATE KEY" in content:
        raise UserError(
            f"{text} is a private key, which nobody else may see: `wildscav season key public {text}` prints "
            "its public half",
            exit_code=2,
        )
    if digits := re.fullmatch(rb"\s*([0-9a-fA-F]{64})\s*", content):
        return _checked(digits[1].decode().lower(), text)
    try:
        key = load_pem_public_key(content)
    except (ValueError, UnsupportedAlgorithm) as error:
        raise UserError(
            f"{text} is not a public key: it must be 64 hexadecimal digits, or a file with them", exit_code=2
        ) from error
    if not isinstance(key, Ed25519PublicKey):
        raise UserError(f"{text} is not an Ed25519 public key", exit_code=2)
    return _digits(key)


def _checked(digits: str, name: str) -> str:
    """Return the digits of a public key, after checking that they are one."""
    try:
        Ed25519PublicKey.from_public_bytes(bytes.fromhex(digits))
    except ValueError as error:
        raise UserError(f"{name} is not a public key", exit_code=2) from error
    return digits


def _content(path: Path, what: str) -> bytes:
    try:
        with path.open("rb") as reader:
            content = reader.read(LONGEST + 1)
    except (OSError, ValueError) as error:
        why = error.strerror if isinstance(error, OSError) else error
        raise UserError(f"the {what} {path} cannot be read: {why}", exit_code=2) from error
    if len(content) > LONGEST:
        raise UserError(f"{path} is not a {what}: it has more than {LONGEST} bytes", exit_code=2)
    return content


def _digits(key: Ed25519PublicKey) -> str:
    return key.public_bytes(Encoding.Raw, PublicFormat.Raw).hex()


def is_signed(content: bytes, signature: str, public: str) -> bool:
    """Return whether a signature of some bytes was made with the private half of a public key.

    They are 128 and 64 hexadecimal digits; any other text is no valid signature, and verifies none.
    """
    try:
        Ed25519PublicKey.from_public_bytes(bytes.fromhex(public)).verify(bytes.fromhex(signature), content)
    except (InvalidSignature, ValueError):
        return False
    return True
