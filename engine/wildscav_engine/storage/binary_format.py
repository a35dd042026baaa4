"""The layout that the engine's binary files share: a JSON header, then a payload of numbers.

Little-endian:

    8 bytes   magic, the kind of file
    2 bytes   format version
    4 bytes   length of the header
    …         header: canonical JSON (sorted keys, no spaces, UTF-8)
    …         payload, which depends on the kind of file
    32 bytes  BLAKE2b of everything before

The checksum detects damage but not forgery.
"""

import json
import struct
import zlib
from collections.abc import Iterator
from hashlib import blake2b
from typing import Any, NamedTuple

PREAMBLE = struct.Struct("<8sHI")
CHECKSUM_SIZE = 32  # bytes
HEADER_LIMIT = 1 << 20  # bytes, which also bounds the memory that parsing takes
CHUNK = 1 << 16  # bytes that are decompressed at a time


class BinaryFormatError(Exception):
    """Some bytes are not a valid file of the expected kind; the message is one line that says why."""


class Layout(NamedTuple):
    """One kind of file."""

    magic: bytes  # 8 bytes
    version: int
    description: str  # with its article, for messages
    earliest: int | None = None  # version that is still read; None: only its own


def pack(layout: Layout, header: dict[str, Any], *payload: bytes | memoryview) -> bytes:
    """Return the bytes of a file with a header and a payload in parts. Equal input gives equal bytes."""
    text = canonical_json(header)
    parts = (PREAMBLE.pack(layout.magic, layout.version, len(text)), text, *payload)
    checksum = blake2b(digest_size=CHECKSUM_SIZE)
    for part in parts:
        checksum.update(part)
    return b"".join((*parts, checksum.digest()))


def unpack(layout: Layout, data: bytes) -> tuple[dict[str, Any], memoryview]:
    """Return the header and the payload of a file.

    Raises:
        BinaryFormatError: It is of another kind or version, truncated, or edited.
    """
    if len(data) < PREAMBLE.size + CHECKSUM_SIZE or not data.startswith(layout.magic):
        raise BinaryFormatError(f"not {layout.description}")
    _, version, header_size = PREAMBLE.unpack_from(data)
    if not (layout.earliest or layout.version) <= version <= layout.version:
        whose = "an earlier" if version < layout.version else "a later"
        readable = " or ".join(str(one) for one in (layout.earliest, layout.version) if one is not None)
        raise BinaryFormatError(
            f"format version {version}, of {whose} engine; this one reads version {readable}"
        )
    if header_size > HEADER_LIMIT:
        raise BinaryFormatError(f"its header has {header_size:,} bytes, {HEADER_LIMIT:,} are allowed")
    body = memoryview(data)[:-CHECKSUM_SIZE]
    if blake2b(body, digest_size=CHECKSUM_SIZE).digest() != data[-CHECKSUM_SIZE:]:
        raise BinaryFormatError("truncated or edited: its checksum does not match")
    text = bytes(body[PREAMBLE.size :][:header_size])
    try:
        header = json.loads(text)
        if not isinstance(header, dict) or canonical_json(header) != text:
            raise ValueError("its header is not in canonical form")
    except (ValueError, RecursionError) as error:
        raise BinaryFormatError(f"its contents are not valid: {error}") from None
    return header, body[PREAMBLE.size + header_size :]


def canonical_json(header: dict[str, Any]) -> bytes:
    """Return a header as JSON in its canonical form."""
    return json.dumps(header, sort_keys=True, separators=(",", ":"), ensure_ascii=False).encode()


def decompress(packed: bytes | memoryview, size: int) -> bytearray:
    """Return decompressed data of exactly ``size`` bytes, without ever decompressing more.

    Raises:
        ValueError: The data has another size.
        zlib.error: The data is damaged.
    """
    content, filled, unpacker = bytearray(size), 0, zlib.decompressobj()
    # In place and in chunks, so that no data is in memory twice.
    for part in _chunks(unpacker, packed):
        content[filled : filled + len(part)] = part
        filled += len(part)
        if filled > size:
            break
    if filled != size or not (unpacker.eof or size == 0) or unpacker.unused_data:
        raise ValueError(f"its arrays do not have the expected size of {size} bytes")
    return content


def _chunks(unpacker: "zlib._Decompress", packed: bytes | memoryview) -> Iterator[bytes]:
    for start in range(0, len(packed), CHUNK):
        part = unpacker.decompress(packed[start : start + CHUNK], CHUNK)
        yield part
        # Input that did not fit stays in unconsumed_tail: after a full chunk, more may follow.
        while len(part) == CHUNK:
            part = unpacker.decompress(unpacker.unconsumed_tail, CHUNK)
            yield part
        if unpacker.unused_data:
            return
