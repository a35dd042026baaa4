"""How long an agent was ready to run and had no processor because of others: a lower bound.

Linux counts for every thread how long it ran and how long it waited for a processor
(``/proc/PID/schedstat``), and for a control group how much processor time all its threads used, children that
have ended included, and how long its own limit held them back. While a thread waits, a processor runs
another thread of the agent, or somebody else's, or the agent's limit holds it back. So what is left of its
wait without the time that the agent's other threads ran, and without the time that its limit held it back,
is the work of others. Threads or children that compete with each other, or with the limit, earn nothing.

The main threads of the agent's first processes are measured, and the one that waited longest counts.
"""

import asyncio
import os
import time
from pathlib import Path
from typing import NamedTuple, Protocol

INTERVAL = 0.25  # s between two looks for new processes
MAX_PROCESSES = 8  # that are measured, so that an agent with many costs the event loop no more time
LONGEST_FILE = 4096  # bytes, of one of the kernel's files of counters


class Group(Protocol):
    """A control group that counts what its processes use."""

    counters: tuple[Path, ...]  # its files of counters

    def members(self) -> list[int]:
        """Return its processes."""
        ...

    def used(self, contents: list[bytes]) -> tuple[float, float]:
        """Return how long its threads ran, and its limit held it back, s, by its counters' contents."""
        ...


class Reading(NamedTuple):
    """The kernel's counters at one moment, s."""

    when: float
    ran: float  # all threads
    held_back: float  # by the agent's own limit
    leaders: dict[int, tuple[float, float]]  # how long the main thread of each process ran, and waited


class GroupMeter:
    """Measures the waits of an agent in a control group. See ``wildscav_server.time_limits.WaitMeter``.

    It keeps the kernel's files open, because opening them takes longer than reading them. OSError if the
    group does not count.
    """

    def __init__(self, group: Group) -> None:
        self._group = group
        self._since: Reading | None = None
        self._files: dict[int, int] = {}  # of processes, by their numbers
        self._counters: list[int] = []
        try:
            self._counters += [os.open(path, os.O_RDONLY) for path in group.counters]
            self._since = self._read()
        except (OSError, ValueError, KeyError) as error:
            self.close()
            raise OSError(f"the control group does not count: {error}") from error

    async def run(self) -> None:
        """Look for new processes until cancelled."""
        try:
            while True:
                self.find_processes()
                await asyncio.sleep(INTERVAL)
        finally:
            self.close()

    def find_processes(self) -> None:
        """Measure new processes of the group, too."""
        for process in self._group.members():
            if len(self._files) >= MAX_PROCESSES:
                break
            if process not in self._files:
                try:
                    self._files[process] = os.open(f"/proc/{process}/schedstat", os.O_RDONLY)
                except OSError:  # it is gone, or the kernel does not count
                    continue

    def close(self) -> None:
        """Close all files; nothing more is measured."""
        for file in (*self._files.values(), *self._counters):
            os.close(file)
        self._files.clear()
        self._counters.clear()

    def start(self) -> None:
        """Begin to measure from now on."""
        self._since = self._read_or_none()

    def waited(self) -> float:
        """Return for how long others kept the agent from running since the start, s; a lower bound."""
        since, now = self._since, self._read_or_none()
        return 0.0 if since is None or now is None else waited_for_others(since, now)

    def ran(self) -> float:
        """Return how long its threads and ended children have run so far, s; OSError if the group is gone."""
        if not self._counters:
            raise OSError("the control group is not measured any more")
        try:
            return self._used()[0]
        except (ValueError, KeyError) as error:  # a file was cut short
            raise OSError(f"the control group does not count: {error}") from error

    def _used(self) -> tuple[float, float]:
        return self._group.used([os.pread(file, LONGEST_FILE, 0) for file in self._counters])

    def _read_or_none(self) -> Reading | None:
        try:
            return self._read() if self._counters else None
        except (OSError, ValueError, KeyError):  # the group is gone
            return None

    def _read(self) -> Reading:
        when, leaders = time.monotonic(), {}
        for process, file in list(self._files.items()):
            try:
                ran, waited, _ = os.pread(file, LONGEST_FILE, 0).split()
            except OSError:  # it has ended
                os.close(self._files.pop(process))
            else:
                leaders[process] = (int(ran) / 1e9, int(waited) / 1e9)
        return Reading(when, *self._used(), leaders)


def waited_for_others(since: Reading, now: Reading) -> float:
    """Return for how long others kept an agent from running between two readings, s; a lower bound."""
    ran, longest = now.ran - since.ran, 0.0
    for process, (leader_ran, leader_waited) in now.leaders.items():
        if process in since.leaders:
            before = since.leaders[process]
            others = max(0.0, ran - (leader_ran - before[0]))  # the agent's other threads
            longest = max(longest, leader_waited - before[1] - others)
    return min(now.when - since.when, max(0.0, longest - (now.held_back - since.held_back)))
