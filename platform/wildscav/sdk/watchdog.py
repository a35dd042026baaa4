"""Print where an agent's code is when its time is up, so that its author finds an endless loop.

The traceback comes from ``faulthandler``, whose watchdog is a thread in C: it prints the Python stack of
every thread to standard error even while the agent's code holds the interpreter's lock. An agent that arms
``faulthandler.dump_traceback_later`` itself shares that one watchdog with the SDK.
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
WARNING_SHARE = 0.9  # of the time to start up: afterwards the host may end the process at any moment
REARM_INTERVAL = 0.5  # s between two settings of the watchdog, and so the most that a traceback comes late
STDERR = 2  # the file descriptor, whatever the agent does with sys.stderr
MOST_TRACEBACKS = 3  # in one match: more would only fill the log


def watch_start_up() -> None:
    """Print the stacks if the agent is still starting up when its time for that is nearly over."""
    try:
        limit = float(os.environ.get(START_VARIABLE, ""))
    except ValueError:
        return
    if 0.0 < limit < threading.TIMEOUT_MAX:
        faulthandler.dump_traceback_later(WARNING_SHARE * limit, file=STDERR)


def end_watch() -> None:
    """Stop watching: what is waited for now is not the agent's code."""
    faulthandler.cancel_dump_traceback_later()


class StepWatchdog:
    """Watches the steps of a match: prints the stacks when an answer takes longer than the agent may take.

    While the event loop turns, the agent's code is not running, and a task moves the watchdog on. So a step
    itself costs nothing.

    Args:
        match: With the limits of the agent's time.
    """

    def __init__(self, match: "MatchInfo") -> None:
        self._budget = match.step_budget
        self.observation: Observation | None = None  # the last one, which says what is left of the time bank
        self._printed = 0

    async def run(self) -> None:
        """Move the watchdog on until cancelled."""
        fires = float("inf")
        try:
            while self._printed < MOST_TRACEBACKS:
                bank = 0.0 if self.observation is None else self.observation.time_bank
                wait = self._budget + bank + REARM_INTERVAL
                faulthandler.dump_traceback_later(wait, file=STDERR)
                fires = time.monotonic() + wait
                await asyncio.sleep(REARM_INTERVAL)
                self._printed += time.monotonic() > fires
        finally:
            end_watch()
