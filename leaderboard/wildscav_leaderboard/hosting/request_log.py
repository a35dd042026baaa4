"""A log line and a count for every request, and for every request that broke something."""

import time
import traceback
from collections.abc import Iterable
from dataclasses import dataclass, field
from http import HTTPStatus

from prometheus_client import Counter, Histogram
from prometheus_client.core import Metric
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from wildscav_leaderboard.api.routers import PREFIX
from wildscav_leaderboard.playing.tables import TableCounts
from wildscav_server.monitoring.logs import Log

TABLES = "/play/"  # paths of people's tables, in which their secrets stand
UNKNOWN_ROUTE = "unknown"  # of an address that leads nowhere
BOUNDS = (0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 10.0, 60.0)  # s


class RequestCounts:
    """How many requests there were, and how long they took."""

    def __init__(self) -> None:
        self._requests = Counter(
            "wildscav_season_requests",
            "Requests that were answered, by route.",
            ("method", "route", "status"),
            registry=None,
        )
        self._seconds = Histogram(
            "wildscav_season_request_seconds",
            "Time until the last byte of an answer was sent, by route.",
            ("route",),
            buckets=BOUNDS,
            registry=None,
        )

    def add(self, method: str, route: str, status: int, seconds: float) -> None:
        """Count a request."""
        self._requests.labels(method, route, str(status)).inc()
        self._seconds.labels(route).observe(seconds)

    def collect(self) -> Iterable[Metric]:
        """Return the counts for Prometheus."""
        yield from self._requests.collect()
        yield from self._seconds.collect()


class RequestLog:
    """Logs and counts requests. Middleware, the outermost one.

    Queries, headers and bodies are not logged, because keys and passwords may stand in them. An error that
    nobody expected was answered already, and is logged with its trace.

    Args:
        log: Where they are logged; None logs nothing, and errors go on to the server, which prints them.
    """

    def __init__(self, app: ASGIApp, counts: RequestCounts, log: Log | None) -> None:
        self._app, self._counts, self._log = app, counts, log

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        begun = time.perf_counter()
        statuses: list[int] = []

        async def send_and_note(message: Message) -> None:
            if message["type"] == "http.response.start":
                statuses.append(message["status"])
            await send(message)

        try:
            await self._app(scope, receive, send_and_note)
        except Exception as error:  # noqa: BLE001 (whatever it is, it is logged)
            self._note_error(scope, error)
        finally:
            status = statuses[0] if statuses else HTTPStatus.INTERNAL_SERVER_ERROR
            self._note(scope, status, time.perf_counter() - begun)

    def _note_error(self, scope: Scope, error: Exception) -> None:
        if self._log is None:
            raise error
        trace = "".join(traceback.format_exception(error))
        self._log.warning("request_broke", method=scope["method"], path=_path(scope), trace=trace)

    def _note(self, scope: Scope, status: int, seconds: float) -> None:
        self._counts.add(scope["method"], _route(scope), status, seconds)
        if self._log is None:
            return
        self._log.info(
            "request",
            method=scope["method"],
            path=_path(scope),
            status=int(status),
            milliseconds=round(seconds * 1e3, 1),
            address=(scope.get("client") or ("unknown",))[0],
        )


def _path(scope: Scope) -> str:
    """Return a request's path without the secrets of people's tables."""
    path: str = scope["path"]
    return f"{TABLES}…" if path.startswith(TABLES) else path


def _route(scope: Scope) -> str:
    """Return the path of the route that answered, such as "/matches/{number}"."""
    route = scope.get("route")
    if route is None:
        return scope.get("root_path") or UNKNOWN_ROUTE  # of the static files, or of nothing
    prefix = PREFIX if scope["path"].startswith(f"{PREFIX}/") else ""  # a router's own routes lack it
    return route.path if route.path.startswith(prefix) else f"{prefix}{route.path}"


@dataclass(frozen=True)
class WebCounts:
    """The requests of a web server, and the tables on its site."""

    requests: RequestCounts = field(default_factory=RequestCounts)
    tables: TableCounts = field(default_factory=TableCounts)

    def collect(self) -> Iterable[Metric]:
        """Return the counts for Prometheus."""
        yield from self.requests.collect()
        yield from self.tables.collect()
