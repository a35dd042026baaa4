"""Kernels that clear one match's row of a batch's arrays, or copy it to and from bytes."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.compilation.passed_tables import ADDRESS, ITEM, LENGTH
from wildscav_engine.compilation.tables.array_tables import Addresses, bytes_at


def fills_of(like: Any) -> NDArray[np.uint8]:
    """Return (F,) the byte with which each array of a new batch is filled.

    Args:
        like: A NamedTuple of new, non-empty arrays.

    Raises:
        ValueError: An array is not filled with a single byte value.
    """
    fills = []
    for name, array in zip(like._fields, like, strict=True):
        found = np.unique(array.reshape(-1).view(np.uint8))
        if len(found) != 1:
            raise ValueError(f"{type(like).__name__}.{name} is not full of one byte, but of {found.tolist()}")
        fills.append(found[0])
    return np.array(fills, np.uint8)


@kernel
def clear_rows(table: Addresses, fills: NDArray[np.uint8], rows: NDArray[np.int64]) -> None:
    """Reset some rows of all arrays of a table to their values in a new batch.

    ``fills`` is what ``fills_of`` returned for the arrays, (F,) a byte for each.
    """
    for field in range(table.shape[0]):
        size = row_size(table, field)
        for row in rows:
            memory = bytes_at(table[field, ADDRESS] + row * size, size)
            for index in range(size):
                memory[index] = fills[field]


@kernel
def row_size(table: Addresses, field: int) -> int:
    """Return the size of a row of an array in bytes."""
    size = table[field, ITEM]
    for column in range(LENGTH, table.shape[1]):
        size *= table[field, column]
    return int(size)


@kernel
def copy_row(
    table: Addresses, row: int, sizes: NDArray[np.int64], content: NDArray[np.uint8], writes: bool
) -> None:
    """Copy the beginning of a row of every array of a table to a buffer, or back if ``writes`` is true.

    ``sizes`` is (F,) the bytes of each array; ``content`` is (N,) these bytes, one array after another.
    """
    first = 0
    for field in range(table.shape[0]):
        memory = bytes_at(table[field, ADDRESS] + row * row_size(table, field), sizes[field])
        part = content[first : first + sizes[field]]
        first += sizes[field]
        for index in range(sizes[field]):
            if writes:
                memory[index] = part[index]
            else:
                part[index] = memory[index]
