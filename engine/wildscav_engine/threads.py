"""Work over threads: kernels let go of Python's lock, so threads of Python's own are enough.

Threads of the compiler's own would need every kernel compiled once more for them, and that version is slower.
"""

import os
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import lru_cache
from itertools import pairwise

MOST_HELPERS = 1024


def share(work: Callable[[slice], bool], count: int, parts: int, threads: int) -> bool:
    """Do work on parts of ``range(count)`` until one fails, and return whether none did.

    Every thread begins with the parts that were its own the last time, too, for what they work on lies in the
    cache of its processor core still; who is done takes over what others have left.

    Args:
        work: Does one part.
        count: How much there is.
        parts: How many parts to make of it, at least one; several for each thread if some take longer.
        threads: How many threads share them, the calling one among them.
    """
    threads = min(threads, parts, MOST_HELPERS + 1)
    ends = [count * part // parts for part in range(parts + 1)]
    every = [slice(start, end) for start, end in pairwise(ends)]
    piles = [deque(every[parts * one // threads : parts * (one + 1) // threads]) for one in range(threads)]
    helpers = [_helper(number).submit(_take, work, piles, number) for number in range(1, threads)]
    is_done = _take(work, piles, 0)
    for helper in helpers:
        is_done = (helper.cancel() or helper.result()) and is_done
    return is_done


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
