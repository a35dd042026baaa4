"""Threads that work until they are asked to end: what breaks in one is begun again, and counted."""

import threading
import traceback
from collections.abc import Callable
from contextlib import suppress
from datetime import UTC, datetime

from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.state import RESTARTS, read_state, write_state
from wildscav_server.monitoring.logs import Log, open_log

PAUSE = 5.0  # s before work that broke is begun again


def watched_thread(
    name: str, work: Callable[[], None], ended: threading.Event, database: Database, log: Log | None = None
) -> threading.Thread:
    """Return a thread, not yet started, that does some work until the work returns.

    Args:
        name: What the log and the metric of restarts call it.
        work: Returns when ``ended`` is set; whatever it raises, it is begun again.
        ended: Set when the work is to end.
    """

    def run() -> None:
        while not ended.is_set():
            try:
                work()
            except Exception as error:  # noqa: BLE001 (whatever it is, the thread goes on)
                trace = "".join(traceback.format_exception(error))
                (log or open_log(None)).warning("thread_broke", thread=name, trace=trace)
            else:
                return
            with suppress(Exception):  # most likely it is the database that broke
                _count(database, name)
            ended.wait(PAUSE)

    return threading.Thread(target=run, name=name, daemon=True)


def _count(database: Database, name: str) -> None:
    with database.writing() as session:
        counts = read_state(session, RESTARTS) or {}
        write_state(session, RESTARTS, {**counts, name: counts.get(name, 0) + 1}, datetime.now(UTC))
