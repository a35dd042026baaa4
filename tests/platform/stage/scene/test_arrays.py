"""Files of arrays, read back."""

import numpy as np
import pytest
from tests.platform.stage.scene.packed_files import unpacked

from wildscav_stage.scene.arrays import packed


@pytest.mark.parametrize("shape", [(0, 3), (1, 1), (5, 3), (4, 7, 2)])
def test_arrays_come_back_as_they_were(shape: tuple[int, ...]) -> None:
    random = np.random.default_rng(1)
    arrays = {
        "bytes": random.integers(0, 256, shape, np.uint8),
        "numbers": random.integers(-(2**30), 2**30, shape, np.int32),
    }

    fields, read = unpacked(packed({"name": "π"}, arrays))

    assert fields == {"name": "π"}
    for name, values in arrays.items():
        np.testing.assert_array_equal(read[name], values)
        assert read[name].dtype == values.dtype


def test_the_same_arrays_are_the_same_bytes() -> None:
    arrays = {"a": np.arange(12, dtype=np.int32).reshape(4, 3)}
    assert packed({}, arrays) == packed({}, arrays)
