"""How often an address may ask, and how often a password may be tried."""

import math
import time
from datetime import UTC, datetime, timedelta
from hashlib import blake2b
from http import HTTPStatus
from ipaddress import IPv6Address, IPv6Network

from sqlalchemy import delete, select
from sqlalchemy.orm import Mapped, mapped_column
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Receive, Scope, Send

from wildscav_leaderboard.database.base import Base
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.refusals import TooMuchError


class Use(Base):
    """One use of something that may be used a few times in a minute."""

    __tablename__ = "uses"

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    key: Mapped[str] = mapped_column(index=True)  # digest of what is used, and by whom
    at: Mapped[datetime] = mapped_column(index=True)


# In a minute:
TRIES = 10  # of passwords that are wrong, by address
SIGN_UPS = 10  # accounts, by address
GAMES = 6  # against submissions, by account or address
CODES = 60  # of tables, right or wrong, by everybody; by address as many as TRIES
DOWNLOADS = 30  # of boards with all of their matches, by address
MINUTE = 60.0  # s


class RateLimits:
    """Counts uses in the last minute. All web servers of a season count in its database."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def use(self, most: int | None, *key: str) -> int:
        """Count one use; return how many there were before it.

        Args:
            most: How many may be in a minute; None for any number.

        Raises:
            TooMuchError: There were too many.
        """
        now, name = datetime.now(UTC), _digest(key)
        begin = now - timedelta(seconds=MINUTE)
        with self._database.writing() as session:
            session.execute(delete(Use).where(Use.at <= begin))
            before = list(session.scalars(select(Use.at).filter_by(key=name).order_by(Use.at)))
            if most is not None and len(before) >= most:
                wait = max(1, math.ceil((before[-most] - begin).total_seconds()))
                raise TooMuchError(f"too often: try again in {wait} s")
            session.add(Use(key=name, at=now))
        return len(before)

    def take_back(self, *key: str) -> None:
        """Take the latest use back."""
        latest = select(Use.id).filter_by(key=_digest(key)).order_by(Use.id.desc()).limit(1)
        with self._database.writing() as session:
            session.execute(delete(Use).where(Use.id == latest.scalar_subquery()))


def _digest(key: tuple[str, ...]) -> str:
    """Return what is stored of a key: a name may be long, and is nobody's business."""
    return blake2b("\0".join(key).encode("utf-8", "replace"), digest_size=16).hexdigest()


def subscriber(address: str) -> str:
    """Return what counts as one address: of version 6, all 2⁶⁴ that one subscriber has."""
    try:
        found = IPv6Address(address)
    except ValueError:  # one of version 4, or none
        return address
    return str(found.ipv4_mapped or IPv6Network((found, 64), strict=False))


class AddressCounts:
    """Counts the requests of each address in about the last minute.

    They are as many as there are requests, so counting one takes a microsecond: of each address only the
    counts of this minute and of the one before it are kept, which counts in part.

    Args:
        per_minute: Requests that an address may send in a minute.
    """

    def __init__(self, per_minute: int) -> None:
        self._most, self._minute = per_minute, 0
        self._counts: dict[str, int] = {}
        self._before: dict[str, int] = {}

    def use(self, address: str, moment: float) -> int:
        """Count a request; return in how many seconds there may be another one, 0 if it is allowed.

        Args:
            moment: The time, s.
        """
        minute, passed = divmod(moment, MINUTE)
        if minute != self._minute:
            self._before = self._counts if minute == self._minute + 1 else {}
            self._counts, self._minute = {}, int(minute)
        count, before = self._counts.get(address, 0), self._before.get(address, 0)
        if count + before * (1.0 - passed / MINUTE) >= self._most:
            return self._wait(count, before, passed)
        self._counts[address] = count + 1
        return 0

    def _wait(self, count: int, before: int, passed: float) -> int:
        """Return in how many seconds the counts have become small enough."""
        left = MINUTE - passed  # of this minute; from its end on its own count shrinks as well
        if count < self._most:
            return math.floor(left - MINUTE * (self._most - count) / before) + 1
        return math.floor(left + MINUTE * (1.0 - self._most / count)) + 1


class AddressLimit:
    """Refuses requests of an address that asks too often. Middleware.

    Args:
        per_minute: Requests that an address may send in a minute.
    """

    def __init__(self, app: ASGIApp, per_minute: int) -> None:
        self._app, self._counts = app, AddressCounts(per_minute)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        address = subscriber((scope.get("client") or ("unknown",))[0])
        wait = 0 if scope["type"] != "http" else self._counts.use(address, time.monotonic())
        if not wait:
            await self._app(scope, receive, send)
            return
        status = HTTPStatus.TOO_MANY_REQUESTS
        error = {"error": f"too many requests: try again in {wait} s", "status": status}
        response = JSONResponse(error, status, {"Retry-After": str(wait)})
        await response(scope, receive, send)
