"""The lease: at any time one process at most is the season's conductor.

A lease has an epoch, which rises with every new holder. Whatever a conductor writes, it writes in a
transaction that first checks that its epoch is still the current one. There is one writer at a time, so a
conductor that lost its lease, however late it notices, can change nothing any more.

The times of a lease are those of the database's clock (``clock``): hosts whose own clocks differ by more than
a lease lasts would otherwise take it from each other in turn.
"""

import os
import secrets
import socket
from dataclasses import dataclass
from datetime import datetime, timedelta

from sqlalchemy.orm import Session

from wildscav.errors import WildscavError
from wildscav_leaderboard.conductor.models import Lease

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
