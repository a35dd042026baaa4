"""Rows of arrays are cleared to the byte that new arrays are full of."""

from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from wildscav_engine.compilation.tables.row_copy import fills_of


class Things(NamedTuple):
    count: NDArray[np.int32]
    open: NDArray[np.bool_]


def test_each_array_is_full_of_one_byte() -> None:
    assert fills_of(Things(np.full((2, 3), -1, np.int32), np.ones(2, np.bool_))).tolist() == [255, 1]


@pytest.mark.parametrize("count", [np.full(3, 7, np.int32), np.array([0, -1], np.int32)])
def test_what_one_byte_cannot_fill_is_refused(count: NDArray[np.int32]) -> None:
    with pytest.raises(ValueError, match=r"Things\.count is not full of one byte"):
        fills_of(Things(count, np.zeros(1, np.bool_)))
