"""The web server of a season: uvicorn, with TLS from files or behind a proxy."""

import asyncio
import fcntl
import gc
import sys
import termios
from ipaddress import ip_address, ip_network
from typing import Any

import h11
import uvicorn
from starlette.types import ASGIApp
from uvicorn.protocols.http.h11_impl import H11Protocol

from wildscav_leaderboard.access.rate_limits import subscriber
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.hosting.app import create_app
from wildscav_leaderboard.hosting.request_log import WebCounts
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.spectating.streams import ENDLESS
from wildscav_server.monitoring.logs import Log

INTERVAL = 30.0  # s in which a client reads so much of an answer; in which a request ends, or sends so much:
LEAST = 30 << 10  # bytes
IN_ALL = 800  # connections, less than the files that a process may usually open
OF_ONE = 200  # connections of one address that is no proxy of ours


class GuardedConnection(H11Protocol):
    """A connection of the web server."""

    subscriber = ""
    _received = 0
    _timer: asyncio.TimerHandle | None = None
    _reading: asyncio.TimerHandle | None = None  # set while the client has not read for some time

    def connection_made(self, transport: Any) -> None:
        """Keep a connection, unless there are too many."""
        super().connection_made(transport)
        if self.client and not self._is_proxy(self.client[0]):
            self.subscriber = subscriber(self.client[0])
        others = [getattr(one, "subscriber", "") for one in self.connections]
        if len(others) > IN_ALL or (self.subscriber and others.count(self.subscriber) > OF_ONE):
            transport.abort()
        else:
            self._watch()

    def data_received(self, data: bytes) -> None:
        """Take what a client sent."""
        self._received += len(data)
        super().data_received(data)
        if self._timer is None:
            self._watch()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget a connection."""
        for timer in (self._timer, self._reading):
            if timer is not None:
                timer.cancel()
        super().connection_lost(exc)

    def shutdown(self) -> None:
        """End a stream when the server stops; other answers come to their end."""
        super().shutdown()
        if self.cycle is not None and self.cycle.scope.get(ENDLESS):
            self.transport.abort()

    def pause_writing(self) -> None:
        """Wait for a client that does not read what it asked for, but not for ever."""
        super().pause_writing()
        self._reading = self.loop.call_later(INTERVAL, self._look_at_reader, self._unread())

    def resume_writing(self) -> None:
        """Go on writing."""
        super().resume_writing()
        if self._reading is not None:
            self._reading.cancel()

    def _look_at_reader(self, before: int) -> None:
        """End the connection if the client has read too little of what had not arrived before."""
        unread = self._unread()
        if unread <= before - LEAST:
            self._reading = self.loop.call_later(INTERVAL, self._look_at_reader, unread)
        else:
            self.transport.abort()

    def _unread(self) -> int:
        """Return how many bytes were written that have not arrived: those here, and those of the system."""
        socket = self.transport.get_extra_info("socket")
        queued = fcntl.ioctl(socket.fileno(), termios.TIOCOUTQ, bytes(4))
        return int(self.transport.get_write_buffer_size()) + int.from_bytes(queued, sys.byteorder)

    def _watch(self) -> None:
        self._received = 0
        self._timer = self.loop.call_later(INTERVAL, self._look)

    def _look(self) -> None:
        """End the connection if the request on it makes no progress, for which the client is to blame."""
        self._timer = None
        is_ours = self.transport.get_protocol() is self and self.timeout_keep_alive_task is None
        if not is_ours or self.conn.their_state not in (h11.IDLE, h11.SEND_BODY):
            return  # passed on to a WebSocket; between two requests; complete
        if self._received >= LEAST or self.flow.read_paused:
            self._watch()
        else:
            self.transport.abort()

    def _is_proxy(self, host: str) -> bool:
        """Return whether an address is of a reverse proxy, which passes the requests of many on."""
        proxies = self.config.forwarded_allow_ips if self.config.proxy_headers else ()
        return any(ip_address(host) in ip_network(one, strict=False) for one in proxies)


GRACE = 10  # s for requests to end when the server is stopped
LARGEST_MESSAGE = 4096  # bytes, through the WebSocket of a page on which somebody plays


def run_web(
    season: Season, database: Database, counts: WebCounts | None = None, log: Log | None = None
) -> None:
    """Serve the web site and the API until the process is told to end."""
    config = configured(season, create_app(season, database, counts, log))
    # What is loaded by now stays: a full collection that went through it would answer nobody for 0.1 s.
    gc.collect()
    gc.freeze()
    uvicorn.Server(config).run()


def configured(season: Season, app: ASGIApp) -> uvicorn.Config:
    """Return how uvicorn serves a season's application."""
    web = season.settings.web
    return uvicorn.Config(
        app,
        host=web.host,
        port=web.port,
        log_level="warning",
        access_log=False,
        proxy_headers=bool(web.proxies),
        forwarded_allow_ips=list(web.proxies) or None,
        ssl_certfile=None if web.certificate is None else str(season.folder / web.certificate),
        ssl_keyfile=None if web.key is None else str(season.folder / web.key),
        timeout_graceful_shutdown=GRACE,
        http=GuardedConnection,
        ws="websockets-sansio",
        ws_max_size=LARGEST_MESSAGE,
        ws_per_message_deflate=False,  # pictures are compressed already
        server_header=False,
    )
