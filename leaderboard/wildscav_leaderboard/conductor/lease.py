"""The lease, and what renews it: at any time one process at most is the season's conductor.

A lease has an epoch, which rises with every new holder. Whatever a conductor writes, it writes in a
transaction that first checks that its epoch is still the current one. There is one writer at a time, so a
conductor that lost its lease, however late it notices, can change nothing any more.

The times of a lease are those of the database's clock (``clock``): hosts whose own clocks differ by more than
a lease lasts would otherwise take it from each other in turn.
"""

import os
import secrets
import signal
import socket
import threading
from dataclasses import dataclass
from datetime import datetime, timedelta
from types import FrameType
from typing import Any, Self

from sqlalchemy.orm import Session

from wildscav.errors import WildscavError
from wildscav_leaderboard.conductor.models import Lease
from wildscav_leaderboard.database.connection import Database, DatabaseError, clock
from wildscav_leaderboard.seasons.watchdog import watched_thread
from wildscav_server.monitoring.logs import Log

NAME = "conductor"
LASTS = timedelta(seconds=30)
RENEWED_EVERY = 5.0  # s


class LeaseLostError(WildscavError):
    """Another process is the conductor now."""


@dataclass(frozen=True)
class Holding:
    """A lease that a process got."""

    holder: str
    epoch: int


def new_holder() -> str:
    """Return a name for this process as a holder, which no other process has."""
    return f"{socket.gethostname()}/{os.getpid()}/{secrets.token_hex(4)}"


def acquire(session: Session, holder: str, now: datetime) -> Holding | None:
    """Take the lease if nobody holds it; return None if somebody does."""
    lease = session.get(Lease, NAME)
    if lease is None:
        session.add(Lease(name=NAME, holder=holder, epoch=1, until=now + LASTS))
        return Holding(holder, 1)
    # A moment far ahead was written by a clock that was wrong.
    if now < lease.until <= now + 2 * LASTS:
        return None
    lease.holder, lease.epoch, lease.until = holder, lease.epoch + 1, now + LASTS
    return Holding(holder, lease.epoch)


def check(session: Session, holding: Holding) -> Lease:
    """Return the lease, which this process still holds.

    Raises:
        LeaseLostError: It does not.
    """
    lease = session.get(Lease, NAME)
    if lease is None or (lease.holder, lease.epoch) != (holding.holder, holding.epoch):
        raise LeaseLostError("another process is the conductor now")
    return lease


def renew(session: Session, holding: Holding, now: datetime) -> None:
    """Hold the lease for longer.

    Raises:
        LeaseLostError: Another process holds it.
    """
    check(session, holding).until = now + LASTS


def release(session: Session, holding: Holding, now: datetime) -> None:
    """Give the lease back, so that the next conductor need not wait.

    Raises:
        LeaseLostError: Another process holds it.
    """
    check(session, holding).until = now


def holder_of(session: Session, now: datetime) -> str | None:
    """Return who is the conductor; None if nobody is."""
    lease = session.get(Lease, NAME)
    return lease.holder if lease is not None and lease.until > now else None


# Interrupts the main thread. It is none that a terminal sends, which the conductor's process ignores.
INTERRUPT = signal.SIGUSR1


class LeaseKeeper:
    """Renews a lease until it exits, and interrupts the work when the lease is lost. A context manager.

    Only the main thread can be interrupted; in another one, the next step notices that the lease is lost.

    Args:
        database: The database, of which it uses connections of its own.
        every: How often it renews the lease, s.
        log: Where to report that it broke and goes on.
    """

    def __init__(
        self, database: Database, holding: Holding, every: float = RENEWED_EVERY, log: Log | None = None
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
                    renew(session, self._holding, clock(session))
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
