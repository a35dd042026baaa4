"""How often an address may ask, and how often a password may be tried."""

import math
import time
from http import HTTPStatus

from limits import RateLimitItem, RateLimitItemPerMinute
from limits.storage import MemoryStorage
from limits.strategies import MovingWindowRateLimiter
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Receive, Scope, Send

from wildscav_leaderboard.seasons.refusals import TooMuchError

TRIES = RateLimitItemPerMinute(10)  # of passwords, by address and by name
SIGN_UPS = RateLimitItemPerMinute(10)  # accounts, by address
GAMES = RateLimitItemPerMinute(6)  # against submissions, by account or address
MINUTE = 60.0  # s


class RateLimits:
    """Counts tries of each address and each name in the last minute, in this process's memory."""

    def __init__(self) -> None:
        self._limiter = MovingWindowRateLimiter(MemoryStorage())

    def use(self, item: RateLimitItem, *key: str) -> None:
        """Count one use.

        Raises:
            TooMuchError: There were too many.
        """
        if not self._limiter.hit(item, *key):
            raise TooMuchError(f"too often: try again in {self.wait(item, *key)} s")

    def wait(self, item: RateLimitItem, *key: str) -> int:
        """Return in how many seconds there may be another use."""
        return max(1, math.ceil(self._limiter.get_window_stats(item, *key).reset_time - time.time()))


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
            address: Whose it is.
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
        app: The application.
        per_minute: Requests that an address may send in a minute.
    """

    def __init__(self, app: ASGIApp, per_minute: int) -> None:
        self._app, self._counts = app, AddressCounts(per_minute)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        address = (scope.get("client") or ("unknown",))[0]
        wait = 0 if scope["type"] != "http" else self._counts.use(address, time.monotonic())
        if not wait:
            await self._app(scope, receive, send)
            return
        status = HTTPStatus.TOO_MANY_REQUESTS
        error = {"error": f"too many requests: try again in {wait} s", "status": status}
        response = JSONResponse(error, status, {"Retry-After": str(wait)})
        await response(scope, receive, send)
