"""The thread that renews the conductor's lease while it works."""

import signal
import threading
from types import FrameType
from typing import Any, Self

from wildscav_leaderboard.conductor import lease
from wildscav_leaderboard.conductor.lease import Holding, LeaseLostError
from wildscav_leaderboard.database.connection import Database, DatabaseError, clock
from wildscav_leaderboard.seasons.watchdog import watched_thread
from wildscav_server.monitoring.logs import Log

# Interrupts the main thread. It is none that a terminal sends, which the conductor's process ignores.
INTERRUPT = signal.SIGUSR1


class LeaseKeeper:
    """Renews a lease until it exits, and interrupts the work when the lease is lost. A context manager.

    Only the main thread can be interrupted; in another one, the next step notices that the lease is lost.

    Args:
        database: The database, of which it uses connections of its own.
        holding: The lease.
        every: How often it renews the lease, s.
        log: Where to report that it broke and goes on.
    """

    def __init__(
        self,
        database: Database,
        holding: Holding,
        every: float = lease.RENEWED_EVERY,
        log: Log | None = None,
    ) -> None:
        self._database, self._holding, self._every = database, holding, every
        self._ended, self._lost = threading.Event(), False
        self._thread = watched_thread("lease", self._keep, self._ended, database, log)
        self._is_main = threading.current_thread() is threading.main_thread()
        self._before: Any = None

    def __enter__(self) -> Self:
        if self._is_main:
            self._before = signal.signal(INTERRUPT, self._interrupt)
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        """Stop renewing.

        Raises:
            LeaseLostError: The work was interrupted because the lease is lost.
        """
        self._ended.set()
        self._thread.join()
        if self._is_main:
            signal.signal(INTERRUPT, self._before)
        if self._lost and kind is KeyboardInterrupt:
            raise LeaseLostError("another process is the conductor now")

    def _keep(self) -> None:
        while not self._ended.wait(self._every):
            try:
                with self._database.writing() as session:
                    lease.renew(session, self._holding, clock(session))
            except LeaseLostError:
                self._lost = True
                if self._is_main:
                    signal.pthread_kill(threading.main_thread().ident or 0, INTERRUPT)
                return
            except DatabaseError:
                continue  # it may come back before the lease ends; every step checks the lease anyway

    def _interrupt(self, _number: int, _frame: FrameType | None) -> None:
        if not self._ended.is_set():
            raise KeyboardInterrupt
