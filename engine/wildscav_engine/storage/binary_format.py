"""The layout that the engine's own binary files share: a header that can be read, and numbers behind it.

Little-endian:

    8 bytes   magic, the kind of file
    2 bytes   format version
    4 bytes   length of the header
    …         header: canonical JSON (sorted keys, no spaces, UTF-8)
    …         payload, as the kind of file has it
    32 bytes  BLAKE2b of everything before

The checksum finds damage, not forgery.
"""

import json
import struct
import zlib
from collections.abc import Iterator
from hashlib import blake2b
from typing import Any, NamedTuple

PREAMBLE = struct.Struct("<8sHI")
CHECKSUM_SIZE = 32  # bytes
HEADER_LIMIT = 1 << 20  # bytes: what can be made of them in memory is bounded, too
CHUNK = 1 << 16  # bytes that are unpacked at once


class ContainerError(Exception):
    """Some bytes are not the file they should be; the message is one line that says why."""


class Layout(NamedTuple):
    """One kind of file."""

    magic: bytes  # 8 bytes
    version: int
    what: str  # it is, with its article


def pack(layout: Layout, header: dict[str, Any], *payload: bytes | memoryview) -> bytes:
    """Return a header and the parts of a payload as one file; the same ones give the same bytes."""
    text = canonical(header)
    parts = (PREAMBLE.pack(layout.magic, layout.version, len(text)), text, *payload)
    checksum = blake2b(digest_size=CHECKSUM_SIZE)
    for part in parts:
        checksum.update(part)
    return b"".join((*parts, checksum.digest()))


def unpack(layout: Layout, data: bytes) -> tuple[dict[str, Any], memoryview]:
    """Return the header and the payload of a file.

    Raises:
        ContainerError: It is of another kind or version, cut short, or edited.
    """
    if len(data) < PREAMBLE.size + CHECKSUM_SIZE or not data.startswith(layout.magic):
        raise ContainerError(f"not {layout.what}")
    _, version, header_size = PREAMBLE.unpack_from(data)
    if version != layout.version:
        whose = "an earlier" if version < layout.version else "a later"
        raise ContainerError(
            f"format version {version}, of {whose} engine; this one reads version {layout.version}"
        )
    if header_size > HEADER_LIMIT:
        raise ContainerError(f"its header has {header_size:,} bytes, {HEADER_LIMIT:,} are allowed")
    body = memoryview(data)[:-CHECKSUM_SIZE]
    if blake2b(body, digest_size=CHECKSUM_SIZE).digest() != data[-CHECKSUM_SIZE:]:
        raise ContainerError("cut short or edited: its checksum does not match")
    text = bytes(body[PREAMBLE.size :][:header_size])
    try:
        header = json.loads(text)
        if not isinstance(header, dict) or canonical(header) != text:
            raise ValueError("its header is not in canonical form")
    except (ValueError, RecursionError) as error:
        raise ContainerError(f"its contents are not valid: {error}") from None
    return header, body[PREAMBLE.size + header_size :]


def canonical(header: dict[str, Any]) -> bytes:
    """Return a header as JSON in the one form that it may have."""
    return json.dumps(header, sort_keys=True, separators=(",", ":"), ensure_ascii=False).encode()


def decompress(packed: bytes | memoryview, size: int) -> bytearray:
    """Return what was compressed, which must have just this size; never unpacks more than that.

    Raises:
        ValueError: It has another size.
        zlib.error: It is damaged.
    """
    content, filled, unpacker = bytearray(size), 0, zlib.decompressobj()
    # In place and piece by piece, so that nothing of it is in memory twice.
    for part in _pieces(unpacker, packed):
        content[filled : filled + len(part)] = part
        filled += len(part)
        if filled > size:
            break
    if filled != size or not (unpacker.eof or size == 0) or unpacker.unused_data:
        raise ValueError(f"its arrays do not have the {size} bytes that they should take")
    return content


def _pieces(unpacker: "zlib._Decompress", packed: bytes | memoryview) -> Iterator[bytes]:
    for start in range(0, len(packed), CHUNK):
        part = unpacker.decompress(packed[start : start + CHUNK], CHUNK)
        yield part
        # It keeps what it has no room for: as long as a piece is full, more may follow.
        while len(part) == CHUNK:
            part = unpacker.decompress(unpacker.unconsumed_tail, CHUNK)
            yield part
        if unpacker.unused_data:
            return
