"""Connections of the web server: they end if clients only keep them open, and nobody can use all of them."""

import asyncio
from ipaddress import ip_address, ip_network
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from wildscav_leaderboard.access.rate_limits import subscriber

INTERVAL = 30.0  # s in which a request comes to its end, headers and body, or has sent so much more:
LEAST = 30 << 10  # bytes
IN_ALL = 800  # connections, less than the files that a process may usually open
OF_ONE = 200  # connections of one address that is no proxy of ours


class GuardedConnection(H11Protocol):
    """A connection of the web server."""

    subscriber = ""
    _received = 0
    _timer: asyncio.TimerHandle | None = None

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
        if self._timer is not None:
            self._timer.cancel()
        super().connection_lost(exc)

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
