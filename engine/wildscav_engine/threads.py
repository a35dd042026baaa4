"""Work over threads: kernels let go of Python's lock, so a pool of its threads is enough.

Threads of the compiler's own would need every kernel compiled once more for them, and that version is slower.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from itertools import pairwise


def share(work: Callable[[slice], bool], count: int, parts: int, threads: int) -> bool:
    """Do work on parts of ``range(count)`` until one fails, and return whether none did.

    The calling thread works, too: the others take a while to wake up.

    Args:
        work: Does one part.
        count: How much there is.
        parts: How many parts to make of it, at least one; several for each thread if some take longer.
        threads: How many threads share them.
    """
    ends = [count * part // parts for part in range(parts + 1)]
    left = iter([slice(start, end) for start, end in pairwise(ends)])

    def take() -> bool:
        return all(work(part) for part in left)

    helpers = [_pool(threads - 1).submit(take) for _ in range(min(threads, parts) - 1)]
    is_done = take()
    for helper in helpers:
        is_done = (helper.cancel() or helper.result()) and is_done
    return is_done


@lru_cache(maxsize=4)
def _pool(threads: int) -> ThreadPoolExecutor:
    """Return threads that wait for work: to start them takes longer than a few steps or images."""
    return ThreadPoolExecutor(threads, thread_name_prefix="wildscav")


# A forked process has no threads but its first: it makes its own.
os.register_at_fork(after_in_child=_pool.cache_clear)
