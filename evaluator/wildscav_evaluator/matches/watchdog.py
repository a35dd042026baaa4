"""The watchdog, which detects from a worker's events that the worker hangs.

What counts is progress: a worker whose match stands still while its event loop keeps running hangs just as
much as one that is stuck in a kernel or was stopped.
"""

from dataclasses import dataclass

from wildscav_evaluator.matches.jobs import Heartbeat, Job, JobEvent, RenderingReplay
from wildscav_server.time_limits import Clock

CHECK_INTERVAL = 1.0  # s between two checks of the workers, at most


@dataclass(frozen=True)
class ProgressTimeouts:
    """How long a job may make no progress, s: many times what each phase takes on an idle machine."""

    set_up: float = 300.0  # to generate the map (the largest takes half a minute) and for all agents to join
    seat: float = 30.0  # more set-up time for each agent that a sandbox has to start
    step: float = 90.0  # for a step, in addition to the time that agents have for it
    rendering: float = 300.0  # for the replay, in addition to the game time that it shows

    def with_job(self, job: Job, event: JobEvent | None) -> tuple[float, str]:
        """Return how long a job may make no progress after an event, s, and a description of its phase."""
        if isinstance(event, RenderingReplay):
            return self.rendering + job.spec.time_limit, "while it rendered the replay"
        if isinstance(event, Heartbeat) and event.steps:
            clock = Clock(longest=job.limits.wall_clock).fitted(job.spec)
            # Besides its budget, as much may be credited to a seat.
            return self.step + 2.0 * clock.step_budget + clock.time_bank, f"after step {event.steps:,}"
        return self.set_up + self.seat * len(job.seats), "before the first step"


class Watchdog:
    """Watches a worker that runs one job."""

    def __init__(self, job: Job, timeouts: ProgressTimeouts) -> None:
        self._job, self._timeouts = job, timeouts
        self._last_event: JobEvent | None = None
        self._still = 0.0  # s without progress

    def hear(self, event: JobEvent) -> None:
        """Note an event that a worker sent."""
        if isinstance(event, Heartbeat) and event == self._last_event:
            return  # the worker lives, but the match makes no progress
        self._last_event, self._still = event, 0.0

    def wait(self, seconds: float) -> None:
        """Note that some time has passed; call this before noting the events of that time.

        If it is far longer than a check takes, the watchdog itself was stopped (by Ctrl-Z, say), most likely
        together with the worker, so the excess does not count.
        """
        self._still += min(seconds, 2.0 * CHECK_INTERVAL)

    @property
    def verdict(self) -> str:
        """A line that says that the worker hangs; empty if it does not."""
        limit, where = self._timeouts.with_job(self._job, self._last_event)
        if self._still <= limit:
            return ""
        return f"the worker process hung: no progress in {limit:,.0f} s {where}"
