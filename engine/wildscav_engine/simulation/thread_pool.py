"""Threads that play a batch together, and never wait for Python's lock in between.

To wake a thread, and to hand it Python's lock, takes longer than a step of many matches. So helpers watch a
number, in a kernel that has let go of that lock, and begin when it grows; only when nothing was to be done
for a while do they fall asleep. Each begins with the rows that were its own the last time, too, which lie in
the cache of its processor core still; who is done takes over what others have left. Nobody waits for a helper
that has not begun.
"""

import os
import threading
import weakref
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.array_tables import COLUMNS, Addresses, reader
from wildscav_engine.compilation.atomics import count_one, number_now, raise_to, tell
from wildscav_engine.compilation.kernel import config, kernel
from wildscav_engine.parallel.threads import cores
from wildscav_engine.simulation.play import play_batch
from wildscav_engine.specs.actions import FIELDS

LINE = 8  # numbers of a cache line: no two that different threads write share one
TICKETS = 0  # where it says how many jobs were given
LOOKS = 500_000  # that a helper looks for a job before it sleeps: a third of a millisecond


class Job(NamedTuple):
    """One step of a batch: the arguments of ``play_batch``."""

    bank: NDArray[np.int64]
    agents: Addresses
    supplies: Addresses
    every: Addresses
    seen: Addresses
    rows: NDArray[np.int64]
    allowed: NDArray[np.bool_]
    rules: NDArray[np.float64]
    frames_per_action: NDArray[np.int64]  # (1,)
    actions: NDArray[np.float32]


_TABLE = np.zeros((1, COLUMNS), np.int64)
_EXAMPLE = Job(
    _TABLE[np.newaxis],
    _TABLE,
    _TABLE,
    _TABLE,
    _TABLE,
    np.zeros(1, np.int64),
    np.zeros(1, np.bool_),
    np.zeros(1),
    np.zeros(1, np.int64),
    np.zeros((1, 1, FIELDS), np.float32),
)
job_at = reader(_EXAMPLE)


def most_together() -> int:
    """Return how many threads can play at once: where nothing is compiled, Python lets one."""
    return 1 if config.DISABLE_JIT else cores()


class _Desk:
    """What the members of a crew share; the leader is number 0."""

    def __init__(self, size: int) -> None:
        self.size = size
        self.job = np.zeros((len(Job._fields), COLUMNS), np.int64)
        # Tickets; then, each on a line of its own: how many rows of each pile are taken; and of each member
        # the last job that it has done, and the last that it has begun, or was too late for.
        self.counts = np.zeros(LINE * (1 + 3 * size), np.int64)
        self.lock = threading.Lock()
        self.sleepers: dict[int, threading.Event] = {}
        self.is_closed = False

    def close(self) -> None:
        """Let the helpers end."""
        with self.lock:
            self.is_closed = True
            self._wake()

    def give(self, job: Addresses) -> None:
        """Give everybody a job."""
        self.job[:] = job
        self.counts[LINE : LINE * (1 + self.size)] = 0
        with self.lock:
            self.counts[TICKETS] += 1
            self._wake()

    def _wake(self) -> None:
        for alarm in self.sleepers.values():
            alarm.set()
        self.sleepers.clear()

    def sleep(self, member: int) -> None:
        """Sleep until there is a job that a helper has not done, or no more at all."""
        alarm = threading.Event()
        with self.lock:
            if self.is_closed or self.counts[TICKETS] > self.counts[LINE * (1 + 2 * self.size + member)]:
                return
            self.sleepers[member] = alarm
        alarm.wait()


class Crew:
    """A few threads, the calling one among them, that play batches together."""

    def __init__(self, size: int) -> None:
        """Start the helpers. They end when nobody holds the crew any more."""
        self._desk = _Desk(size)
        for member in range(1, size):
            threading.Thread(
                target=_serve, args=(self._desk, member), name=f"wildscav-{member}", daemon=True
            ).start()
        weakref.finalize(self, self._desk.close).atexit = False

    def play(self, job: Addresses) -> None:
        """Play one step of a batch; see ``Job``. What it is about is kept alive by the caller."""
        self._desk.give(job)
        play_together(self._desk.job, self._desk.counts, 0, self._desk.size, 0)


def _serve(desk: _Desk, member: int) -> None:
    """Do the jobs of a desk as they come."""
    while not desk.is_closed:
        play_together(desk.job, desk.counts, member, desk.size, LOOKS)
        desk.sleep(member)


class _Crews(threading.local):
    """The crews of one thread: nobody else gives them jobs, so they are there when they are needed."""

    def __init__(self) -> None:
        self.of_size: dict[int, Crew] = {}


_crews = _Crews()


def crew(size: int) -> Crew:
    """Return the calling thread's crew of so many threads."""
    found = _crews.of_size
    if size not in found:
        found[size] = Crew(size)
    return found[size]


def _forget_crews() -> None:
    global _crews  # noqa: PLW0603
    _crews = _Crews()


# A forked process has no threads but its first: it starts its own helpers.
os.register_at_fork(after_in_child=_forget_crews)


@kernel
def play_together(job: Addresses, counts: NDArray[np.int64], member: int, size: int, looks: int) -> None:
    """Play a job as its leader (member 0), until all have done their part; or jobs as a helper, as they come.

    Args:
        job: The table of a ``Job``.
        counts: See ``_Desk``.
        member: Whose part this is.
        size: How many members there are.
        looks: How often a helper looks for the next job before it gives up.
    """
    own = LINE * (1 + size + member)
    begun = number_now(counts, own + LINE * size)
    looked = 0
    while looked <= looks:
        job_number = number_now(counts, TICKETS)
        if job_number > begun:
            # The leader may have taken it from a helper who is late.
            if raise_to(counts, own + LINE * size, job_number) < job_number:
                _play_piles(job, counts, member, size)
                tell(counts, own, job_number)
            begun, looked = job_number, 0
        looked += 1
    if member == 0:
        for helper in range(1, size):
            theirs = LINE * (1 + size + helper)
            if raise_to(counts, theirs + LINE * size, begun) >= begun:
                while number_now(counts, theirs) < begun:
                    pass


@kernel
def _play_piles(table: Addresses, counts: NDArray[np.int64], member: int, size: int) -> None:
    """Play the rows of a member's own pile, then those that others have left."""
    job = job_at(table)
    for turn in range(size):
        pile = (member + turn) % size
        first, last = job.rows.shape[0] * pile // size, job.rows.shape[0] * (pile + 1) // size
        row = first + count_one(counts, LINE * (1 + pile))
        while row < last:
            play_batch(
                job.bank,
                job.agents,
                job.supplies,
                job.every,
                job.seen,
                job.rows[row : row + 1],
                job.actions,
                job.allowed,
                job.frames_per_action[0],
                job.rules,
                False,
            )
            row = first + count_one(counts, LINE * (1 + pile))
