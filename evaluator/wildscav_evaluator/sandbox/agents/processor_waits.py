"""How long an agent's processes were ready to run and had no processor: the machine's fault, not theirs.

Linux counts for every thread how long it ran and how long it waited for a processor, in
``/proc/PID/schedstat``. This module uses the main thread of the process that waited longest. Waits that the
agent causes itself do not count: the time that its other threads ran, for which the main thread may have
waited, and times in which the agent used all the processor time that its limit allows.
"""

import asyncio
import contextlib
import os
import time
from bisect import bisect_right
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

INTERVAL = 0.25  # s between two samples
USED_UP = 0.9  # share of its limit on processor time from which an agent's waits are its own fault
TICKS = os.sysconf("SC_CLK_TCK") if hasattr(os, "sysconf") else 100  # per second, in a process's times


class Sample(NamedTuple):
    """The kernel's counters of one process."""

    main_ran: float  # s, its main thread
    main_waited: float  # s, its main thread
    ran: float  # s, all threads


class WaitMeter:
    """Samples one agent's processes, and computes how long they waited for a processor.

    Args:
        processes: Returns the current numbers of the agent's processes.
        cpus: Cores' worth of processor time that the agent may use.
    """

    def __init__(self, processes: Callable[[], Iterable[int]], cpus: float) -> None:
        self._processes, self._cpus = processes, cpus
        self._last: dict[int, Sample] = {}
        self._times = [time.monotonic()]
        self._waited = [0.0]  # s in total, at those times

    async def run(self) -> None:
        """Take samples until cancelled."""
        while True:
            self.take()
            await asyncio.sleep(INTERVAL)

    def take(self) -> None:
        """Take a sample."""
        now = time.monotonic()
        samples = {process: sample for process in self._processes() if (sample := take_sample(process))}
        grown = [
            Sample(*(new - old for new, old in zip(sample, self._last[process], strict=True)))
            for process, sample in samples.items()
            if process in self._last
        ]
        self._last = samples
        seconds = now - self._times[-1]
        self._times.append(now)
        self._waited.append(self._waited[-1] + self._processor_wait(grown, seconds))

    def _processor_wait(self, grown: list[Sample], seconds: float) -> float:
        """Return for how long since the last sample the machine had no processor for the agent, s."""
        ran = sum(sample.ran for sample in grown)
        if not grown or ran >= USED_UP * self._cpus * seconds:
            return 0.0
        longest = max(grown, key=lambda sample: sample.main_waited)
        others = max(0.0, ran - longest.main_ran)
        return min(seconds, max(0.0, longest.main_waited - others))

    def waited(self, start: float, end: float) -> float:
        """Return how long the agent waited for a processor between two moments, s.

        Args:
            start: By the monotonic clock.
            end: By the same clock.
        """
        return self._until(end) - self._until(start)

    def _until(self, moment: float) -> float:
        """Return how long it had waited up to a moment, s, interpolated linearly between samples."""
        after = bisect_right(self._times, moment)
        if after in (0, len(self._times)):
            return self._waited[0 if after == 0 else -1]
        before, share = after - 1, 0.0
        if self._times[after] > self._times[before]:
            share = (moment - self._times[before]) / (self._times[after] - self._times[before])
        return self._waited[before] + share * (self._waited[after] - self._waited[before])


def take_sample(process: int) -> Sample | None:
    """Return the kernel's counters of a process; None if it is gone, or the kernel does not count."""
    with contextlib.suppress(OSError, ValueError, IndexError):
        folder = Path(f"/proc/{process}")
        ran, waited, _ = (folder / "schedstat").read_text("ascii").split()
        # "pid (name) state …"; the name may hold spaces and brackets.
        fields = (folder / "stat").read_text("utf-8", "replace").rpartition(")")[2].split()
        user, system = int(fields[11]), int(fields[12])
        return Sample(int(ran) / 1e9, int(waited) / 1e9, (user + system) / TICKS)
    return None
