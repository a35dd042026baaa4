"""Items that several threads process, each by the first thread that comes to it."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Turns(NamedTuple):
    """In which order a thread comes to N items; both arrays are empty for a thread that is alone."""

    order: NDArray[np.int64]  # (N,) the items
    taken: NDArray[np.int64]  # (N,) of each item, 1 once a thread has begun with it; all threads share it


ALONE = Turns(np.zeros(0, np.int64), np.zeros(0, np.int64))


def turns_of(count: int, threads: int) -> list[Turns]:
    """Return the turns of several threads: each comes to a range of its own, then to those of the others.

    A thread has the same range each time, because the cache of its processor core still holds that data. It
    begins with the ranges of others at their ends, where their own threads come last.
    """
    taken = np.zeros(count, np.int64)
    ends = [count * thread // threads for thread in range(threads + 1)]
    ranges = [np.arange(ends[thread], ends[thread + 1]) for thread in range(threads)]
    return [
        Turns(
            np.concatenate([own, *(other[::-1] for other in ranges[thread + 1 :] + ranges[:thread])]), taken
        )
        for thread, own in enumerate(ranges)
    ]


def items_of(turns: Turns, count: int) -> Iterator[int]:
    """Yield the items that a thread must process, of ``count``, as its turns come.

    Two threads that come to an item at the very same moment both process it. So it must do no harm if an item
    is processed twice.
    """
    if not len(turns.order):
        yield from range(count)
    for item in turns.order.tolist():
        if not turns.taken[item]:
            turns.taken[item] = 1
            yield item
