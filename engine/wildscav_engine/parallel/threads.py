"""Work shared by threads: kernels release Python's lock, so threads of Python's own are enough.

To hand work to another thread and to wait for it takes 50 to 100 µs, so a thread is worth waking for half a
millisecond of work or more. Threads that never sleep would begin sooner, but they would take a processor core
from everybody else all the time; Numba's own would need every kernel compiled once more.
"""

import os
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import lru_cache
from itertools import pairwise

MOST_HELPERS = 1024


def cores() -> int:
    """Return how many processor cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def share(work: Callable[[slice], bool], count: int, threads: int, least: int = 1) -> bool:
    """Do work on parts of ``range(count)`` until one fails, and return whether none did.

    Every thread begins with the parts that were its own the last time, too, because the cache of its
    processor core still holds what they work on; a thread that is done takes over what others have left.

    Args:
        work: Does one part.
        count: How much there is.
        threads: How many threads share them at most, the calling one among them.
        least: How much a thread and a part get at least, unless there is less in all.
    """
    threads = min(threads, count // least, MOST_HELPERS + 1)
    if threads <= 1:
        return work(slice(0, count))
    ends = [count * one // threads for one in range(threads + 1)]
    piles = [deque(_halves(first, last, least)) for first, last in pairwise(ends)]
    helpers = [_helper(number).submit(_take, work, piles, number) for number in range(1, threads)]
    is_done = _take(work, piles, 0)
    for helper in helpers:
        is_done = (helper.cancel() or helper.result()) and is_done
    return is_done


def _halves(first: int, last: int, least: int) -> Iterator[slice]:
    """Cut a range into parts: half of it, half of what is left, and so on until that is as little as asked.

    Few, since a thread waits for Python's lock before each; and small at the end, so that all end together.
    """
    while first < last:
        size = min(max((last - first + 1) // 2, least), last - first)
        yield slice(first, first + size)
        first += size


def _take(work: Callable[[slice], bool], piles: list[deque[slice]], own: int) -> bool:
    """Do the parts that ``_parts`` gives until one fails, and return whether none did."""
    return all(map(work, _parts(piles, own)))


def _parts(piles: list[deque[slice]], own: int) -> Iterator[slice]:
    """Yield the parts of one's own pile, then those that others have left, from their far ends."""
    with suppress(IndexError):
        while True:
            yield piles[own].popleft()
    for pile in piles[own + 1 :] + piles[:own]:
        with suppress(IndexError):
            while True:
                yield pile.pop()


@lru_cache(maxsize=MOST_HELPERS)
def _helper(number: int) -> ThreadPoolExecutor:
    """Return a thread that waits for work: to start one takes longer than a few steps or images."""
    return ThreadPoolExecutor(1, thread_name_prefix=f"wildscav-{number}")


# A forked process has no threads but its first: it makes its own.
os.register_at_fork(after_in_child=_helper.cache_clear)
