"""The arrays of a file for a browser, read as ``scene/arrays.py`` describes it."""

import gzip
import json
from typing import Any

import numpy as np
from numpy.typing import NDArray


def unpacked(content: bytes) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return the fields and the arrays of a file."""
    whole = gzip.decompress(content)
    start = 4 + int.from_bytes(whole[:4], "little")
    header = json.loads(whole[4:start])
    arrays = {}
    for each in header.pop("arrays"):
        kind = np.dtype(each["type"]).newbyteorder("<")
        count = int(np.prod(each["shape"]))
        planes = np.frombuffer(whole, kind, count, start + each["at"]).reshape(each["shape"][-1], -1)
        sums = np.cumsum(planes, axis=1, dtype=kind)
        arrays[each["name"]] = sums.T.reshape(each["shape"])
    return header, arrays
