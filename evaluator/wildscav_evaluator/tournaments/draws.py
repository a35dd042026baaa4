"""Random integers in bulk, the same on every machine and with every release of NumPy.

Only the raw words of NumPy's Philox generator are used. NumPy keeps those; it does not promise to keep the
methods that turn them into shuffled arrays and numbers of a range.
"""

from hashlib import blake2b

import numpy as np
from numpy.typing import NDArray


class Draws:
    """A sequence of random integers that only its purpose determines."""

    def __init__(self, *purpose: object) -> None:
        key = blake2b("/".join(map(str, purpose)).encode(), digest_size=16).digest()
        self._philox = np.random.Philox(key=int.from_bytes(key, "little"))

    def words(self, *shape: int) -> NDArray[np.uint64]:
        """Return 64 random bits for each place of an array."""
        return self._philox.random_raw(int(np.prod(shape))).reshape(shape)

    def order(self, count: int) -> NDArray[np.int64]:
        """Return the numbers 0 to count - 1 in random order."""
        return np.argsort(self.words(count), kind="stable")

    def orders(self, *shape: int) -> NDArray[np.int64]:
        """Return random orders along the last axis."""
        return np.argsort(self.words(*shape), axis=-1, kind="stable")
