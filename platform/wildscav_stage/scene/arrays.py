"""Arrays in one file, for a browser: small, and read without a library.

The file begins with the length of its header in bytes (uint32). The header is JSON, padded with spaces to a
multiple of four bytes. It has the fields that the caller gives and ``arrays``: of each its ``name``, ``type``
(``uint8`` or ``int32``), ``shape``, and where its bytes begin after the header (``at``). All numbers are
little-endian, and each array begins at a multiple of four bytes.

An array is stored as planes, since they compress best: the last axis comes first. Along the others, in their
order, each number is what it is more than the one before (modulo 256 for ``uint8``).
"""

import gzip
import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

ALIGNMENT = 4  # bytes
LEVEL = 6  # of compression


def packed(fields: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """Return a compressed file of some fields and arrays.

    Args:
        fields: What the header says, as JSON.
        arrays: Arrays of uint8 or int32, with two or more axes.
    """
    described, pieces, at = [], [], 0
    for name, values in arrays.items():
        content = _differences(values).tobytes()
        described.append({"name": name, "type": values.dtype.name, "shape": values.shape, "at": at})
        pieces.append(content + bytes(-len(content) % ALIGNMENT))
        at += len(pieces[-1])
    header = json.dumps({**fields, "arrays": described}, separators=(",", ":")).encode()
    header += b" " * (-len(header) % ALIGNMENT)
    length = np.uint32(len(header)).astype("<u4").tobytes()
    return gzip.compress(b"".join((length, header, *pieces)), LEVEL, mtime=0)


def _differences(values: NDArray[Any]) -> NDArray[Any]:
    """Return (C, N) planes of an array (…, C), each number less the one before."""
    planes = values.reshape(-1, values.shape[-1]).T
    return np.diff(planes, axis=1, prepend=planes.dtype.type(0)).astype(values.dtype.newbyteorder("<"))
