"""Parallel work in Python threads, which suffice because kernels release the GIL.

Passing work to another thread and waiting for it takes 50 to 100 µs, so waking a thread pays off from half a
millisecond of work. Spinning threads would start sooner, but each would occupy a processor core all the time.
Numba's own threads would require compiling every kernel once more.
"""

import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from functools import lru_cache
from itertools import pairwise

from wildscav_engine.parallel.turns import ALONE, Turns, turns_of

MAX_HELPERS = 1024


def cores() -> int:
    """Return the number of processor cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def share(work: Callable[[slice], bool], count: int, threads: int, least: int = 1) -> bool:
    """Process ``range(count)`` in parts until one fails, and return whether all succeeded.

    Every thread begins with the same range as in the previous call, because the cache of its processor core
    still holds that data. A thread that has finished its own parts steals parts from the others.

    Args:
        work: Processes one part, and returns whether it succeeded.
        count: The number of items.
        threads: The maximum number of threads, including the calling one.
        least: The minimum number of items of a thread and of a part, unless there are fewer in total.
    """
    threads = min(threads, count // least, MAX_HELPERS + 1)
    if threads <= 1:
        return work(slice(0, count))
    ends = [count * index // threads for index in range(threads + 1)]
    queues = [deque(_halves(first, last, least)) for first, last in pairwise(ends)]
    helpers = [_helper(number).submit(_process_parts, work, queues, number) for number in range(1, threads)]
    is_done = _process_parts(work, queues, 0)
    return _have_succeeded(helpers) and is_done


class SharedWork:
    """Work in compiled code that other threads begin with while the calling one still does something else.

    No thread waits for the GIL between two items.
    """

    def __init__(self, work: Callable[[Turns], bool], count: int, threads: int, least: int = 1) -> None:
        """Let the other threads begin; ``work`` processes the items whose turn comes. See ``share``."""
        self._work = work
        threads = min(threads, count // least, MAX_HELPERS + 1)
        self._own, *others = [ALONE] if threads <= 1 else turns_of(count, threads)
        self._helpers = [_helper(number).submit(work, turns) for number, turns in enumerate(others, 1)]

    def finish(self) -> bool:
        """Process what is left, wait for the others, and return whether all succeeded."""
        is_done = self._work(self._own)
        return _have_succeeded(self._helpers) and is_done


def _have_succeeded(helpers: Sequence[Future[bool]]) -> bool:
    """Wait for other threads, except those that have not begun; return whether all succeeded."""
    succeeded = [helper.cancel() or helper.result() for helper in helpers]
    return all(succeeded)


def _halves(first: int, last: int, least: int) -> Iterator[slice]:
    """Cut a range into parts: one half, half of the rest, and so on down to the minimum size.

    There are few parts, because a thread waits for the GIL before each of them. The last parts are small, so
    that all threads finish at about the same time.
    """
    while first < last:
        size = min(max((last - first + 1) // 2, least), last - first)
        yield slice(first, first + size)
        first += size


def _process_parts(work: Callable[[slice], bool], queues: list[deque[slice]], own: int) -> bool:
    """Process the parts of one thread until one fails, and return whether all succeeded."""
    return all(map(work, _parts(queues, own)))


def _parts(queues: list[deque[slice]], own: int) -> Iterator[slice]:
    """Yield the parts of a thread's own queue, then the remaining parts of the others from their far ends."""
    with suppress(IndexError):
        while True:
            yield queues[own].popleft()
    for queue in queues[own + 1 :] + queues[:own]:
        with suppress(IndexError):
            while True:
                yield queue.pop()


@lru_cache(maxsize=MAX_HELPERS)
def _helper(number: int) -> ThreadPoolExecutor:
    """Return a waiting thread; it is kept, because starting one takes longer than a few steps or images."""
    return ThreadPoolExecutor(1, thread_name_prefix=f"wildscav-{number}")


# A forked process has only its main thread, so it must start its own helpers. Windows does not fork.
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_helper.cache_clear)
