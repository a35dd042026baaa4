"""The watchdog: which workers hang, by what is heard of them.

What counts is progress, not life: a worker whose match stands still while its event loop runs on hangs as
much as one that is stuck in a kernel or was stopped.
"""

from dataclasses import dataclass

from wildscav.server import Clock
from wildscav_evaluator.matches.jobs import Heartbeat, Job, JobEvent, RenderingReplay

CHECK_INTERVAL = 1.0  # s between two looks at the workers, at the most


@dataclass(frozen=True)
class Patience:
    """How long a job may get no further, s: many times what that takes where nothing else is to do."""

    set_up: float = 300.0  # for its map, of which the largest takes half a minute, and for all agents to join
    seat: float = 30.0  # more of that for every agent that a sandbox has to start
    step: float = 90.0  # for a step, beside the time that agents have for it
    rendering: float = 300.0  # for its replay, beside the game time that is shown

    def with_job(self, job: Job, event: JobEvent | None) -> tuple[float, str]:
        """Return how long a job may stay as it is, s, and where it is then.

        Args:
            job: The job.
            event: What was told of it last, if anything.
        """
        if isinstance(event, RenderingReplay):
            return self.rendering + job.spec.time_limit, "while it rendered the replay"
        if isinstance(event, Heartbeat) and event.steps:
            clock = Clock().fitted(job.spec)
            return self.step + clock.step_budget + clock.time_bank, f"after step {event.steps:,}"
        return self.set_up + self.seat * len(job.seats), "before the first step"


class Watchdog:
    """Watches a worker at one job.

    Args:
        job: The job.
        patience: With it.
    """

    def __init__(self, job: Job, patience: Patience) -> None:
        self._job, self._patience = job, patience
        self._last_event: JobEvent | None = None
        self._still = 0.0  # s without progress

    def hear(self, event: JobEvent) -> None:
        """Note what a worker says of its job."""
        if isinstance(event, Heartbeat) and event == self._last_event:
            return  # it lives, and gets nowhere
        self._last_event, self._still = event, 0.0

    def wait(self, seconds: float) -> None:
        """Note that some time has gone by; progress that was made meanwhile is heard of next.

        Args:
            seconds: How long. Far more than a look takes means that the watchdog itself was stopped (by
                Ctrl-Z, say), and most likely the worker with it: that does not count.
        """
        self._still += min(seconds, 2.0 * CHECK_INTERVAL)

    @property
    def verdict(self) -> str:
        """Say that the worker hangs, in a line; nothing if it does not."""
        limit, where = self._patience.with_job(self._job, self._last_event)
        if self._still <= limit:
            return ""
        return f"the worker process hung: no progress in {limit:,.0f} s {where}"
