"""Print where an agent's code is when its time is up, so that its author can find an endless loop.

The traceback comes from ``faulthandler``, whose watchdog is a thread in C: it prints the Python stack of
every thread to standard error even while the agent's code holds the interpreter lock. There is only one such
watchdog, so an agent that calls ``faulthandler.dump_traceback_later`` shares it with the SDK.
"""

import asyncio
import faulthandler
import os
import threading
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wildscav.agent import MatchInfo, Observation

START_VARIABLE = "WILDSCAV_START_LIMIT"  # s that the host gives an agent to start up
WARNING_SHARE = 0.9  # of the time to start up; after all of it, the host may end the process
REARM_INTERVAL = 0.5  # s after which the watchdog is set again, and so the longest delay of a traceback
STDERR = 2  # the file descriptor, because the agent may replace sys.stderr
MAX_TRACEBACKS = 3  # per match; more would only fill the log


def watch_start_up() -> None:
    """Print the stacks if the agent is still starting up when its start-up time is nearly over."""
    try:
        limit = float(os.environ.get(START_VARIABLE, ""))
    except ValueError:
        return
    if 0.0 < limit < threading.TIMEOUT_MAX:
        faulthandler.dump_traceback_later(WARNING_SHARE * limit, file=STDERR)


def end_watch() -> None:
    """Stop watching, because the agent's code is no longer running."""
    faulthandler.cancel_dump_traceback_later()


class StepWatchdog:
    """Watches the steps of a match: prints the stacks when an answer takes longer than it may.

    A task of the event loop, which runs only while the agent's code does not, sets the watchdog again from
    time to time. So it adds no work to a step.
    """

    def __init__(self, match: "MatchInfo") -> None:
        self._budget = match.step_budget
        self.observation: Observation | None = None  # the last one, which says what is left of the time bank
        self._printed = 0

    async def run(self) -> None:
        """Set the watchdog again at intervals until cancelled."""
        fires = float("inf")
        try:
            while self._printed < MAX_TRACEBACKS:
                bank = 0.0 if self.observation is None else self.observation.time_bank
                wait = self._budget + bank + REARM_INTERVAL
                faulthandler.dump_traceback_later(wait, file=STDERR)
                fires = time.monotonic() + wait
                await asyncio.sleep(REARM_INTERVAL)
                self._printed += time.monotonic() > fires
        finally:
            end_watch()
