"""The listener at one address: which connections are accepted, how many, and how fast."""

import asyncio
import contextlib
import socket
import ssl
from collections.abc import Callable, Mapping, Sequence

from wildscav_server.http2.allowance import CONNECTION_COST, GONE_COST, FloodError, TimeShare
from wildscav_server.http2.calls import Route
from wildscav_server.http2.connection import Connection

BACKLOG = 1024  # connections that wait to be accepted
AT_ONCE = 16  # connections accepted before other work gets its turn
OUT_OF_FILES = 1.0  # s to wait when the system has no resources for a connection


class Listener:
    """Accepts and counts connections.

    A client is unknown until a call on its connection has joined a seat or authenticated an organizer. When
    there are too many connections, the oldest one of the peer with the most unknown clients is closed. All
    unknown clients together have a share of the loop's time; when it is used up, none of them is accepted or
    read for a while.

    Args:
        sockets: Bound sockets; they are closed with the listener.
        routes: The route of each method.
        connections: How many connections may be open at one time.
        visits: How many connections are accepted in all; None for any number. A number means that all of them
            come from one agent.
        on_flood: Called with what that agent did when no more connections are accepted from it.
        tls: TLS settings; None if connections are not encrypted.
    """

    def __init__(
        self,
        sockets: Sequence[socket.socket],
        routes: Mapping[str, Route],
        *,
        connections: int,
        visits: int | None = None,
        on_flood: Callable[[str], None] = lambda _: None,
        tls: ssl.SSLContext | None = None,
    ) -> None:
        self.routes, self._sockets, self._tls = routes, list(sockets), tls
        self._limit, self._visit_limit, self._on_flood = connections, visits, on_flood
        self._visits = 0
        self._loop = asyncio.get_running_loop()
        self.share = TimeShare(self._loop.time)
        self.buffer = memoryview(bytearray(65_536))
        self._waiting: dict[Connection, None] = {}  # unknown clients, until there is time for them
        self._open: dict[Connection, asyncio.Task[None]] = {}  # each with the task that sets it up
        self._unknown: dict[str, dict[Connection, None]] = {}  # by peer, in the order of their arrival
        self._paused: asyncio.TimerHandle | None = None  # ends a pause for unknown clients
        self._accepted_last = False  # whether the last turn was that of new connections

    def start(self) -> None:
        """Accept connections."""
        for one in self._sockets:
            one.setblocking(False)
            one.listen(BACKLOG)
        self._listen()

    def _listen(self) -> None:
        for one in self._sockets:
            self._loop.add_reader(one.fileno(), self._accept, one)

    def _stop_listening(self) -> None:
        for one in self._sockets:
            self._loop.remove_reader(one.fileno())

    # New connections.

    def _accept(self, listening: socket.socket, most: int = AT_ONCE) -> None:
        for _ in range(most):
            if not self._sockets:
                return
            if (seconds := self.share.wait()) > 0.0:
                self._pause(seconds)
                return
            try:
                accepted, address = listening.accept()
            except (BlockingIOError, InterruptedError, ConnectionAbortedError):
                return
            except OSError:  # too many open files, or no memory
                self._pause(OUT_OF_FILES)
                return
            if not self._count_visit():
                accepted.close()
                return
            self._add(accepted, str(address[0]) if isinstance(address, tuple) else "")

    def _count_visit(self) -> bool:
        """Count a new connection, and return whether it is within the limit of this address."""
        if self._visit_limit is None:
            return True
        self._visits += 1
        if self._visits > self._visit_limit:
            self._stop_accepting(f"flooded its socket with more than {self._visit_limit} connections")
        return self._visits <= self._visit_limit

    def _stop_accepting(self, reason: str) -> None:
        self.close()
        self._on_flood(reason)

    def flooded(self, error: FloodError) -> None:
        """Accept no more connections, if all of them come from one agent."""
        if self._visit_limit is not None and self._sockets:
            self._stop_accepting(str(error))

    def _add(self, accepted: socket.socket, peer: str) -> None:
        """Set up a connection, unless its client has closed it already."""
        accepted.setblocking(False)
        if _is_gone(accepted):
            self.share.spend(GONE_COST)
            accepted.close()
            return
        self.share.spend(CONNECTION_COST)
        if len(self._open) >= self._limit and not self._evict_unknown():
            accepted.close()
            return
        if accepted.family != socket.AF_UNIX:
            accepted.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        connection = Connection(self, peer, self._tls)
        self._unknown.setdefault(peer, {})[connection] = None
        task = self._loop.create_task(self._set_up(connection, accepted), name="connection")
        # A task that is cancelled before it has begun closes nothing itself.
        task.add_done_callback(lambda done: accepted.close() if done.cancelled() else None)
        self._open[connection] = task

    async def _set_up(self, connection: Connection, accepted: socket.socket) -> None:
        """Create the transport of a connection."""
        try:
            await self._loop.connect_accepted_socket(lambda: connection, accepted)
        except OSError:
            accepted.close()
            self.closed(connection)

    def _evict_unknown(self) -> bool:
        """Close the connection of an unknown client, and return whether there was one."""
        if not self._unknown:
            return False
        of_peer = max(self._unknown.values(), key=len)
        one = next(iter(of_peer))
        self._open[one].cancel()  # if it is still being set up
        one.abort()
        self.closed(one)
        return True

    # The interface for connections.

    def known(self, connection: Connection) -> None:
        """Remove a connection from those of unknown clients."""
        of_peer = self._unknown.get(connection.peer, {})
        of_peer.pop(connection, None)
        if not of_peer:
            self._unknown.pop(connection.peer, None)

    def closed(self, connection: Connection) -> None:
        """Remove a connection that is closed."""
        self._open.pop(connection, None)
        self._waiting.pop(connection, None)
        self.known(connection)

    def wait(self, connection: Connection) -> None:
        """Make an unknown client wait until unknown clients have time again."""
        self._waiting[connection] = None
        self._pause(self.share.wait())

    def _pause(self, seconds: float) -> None:
        """Do nothing for unknown clients for a while."""
        if self._paused is None:
            self._stop_listening()
            self._paused = self._loop.call_later(seconds, self._go_on)

    def _go_on(self) -> None:
        """Alternate between the data of waiting clients, oldest first, and new connections.

        So neither starves the other, even if there is time for only one of them.
        """
        self._paused = None
        while self._waiting and self.share.wait() == 0.0:
            self._accepted_last = not self._accepted_last
            if self._accepted_last:
                for one in tuple(self._sockets):
                    self._accept(one, most=1)
            else:
                oldest = next(iter(self._waiting))
                del self._waiting[oldest]
                oldest.resume()
        if (seconds := self.share.wait()) > 0.0:
            self._pause(seconds)
        elif self._paused is None:
            self._listen()

    # Its end.

    def close(self) -> None:
        """Accept no more connections; open ones stay open."""
        self._stop_listening()
        for one in self._sockets:
            one.close()
        self._sockets.clear()

    async def stop(self, grace: float) -> None:
        """Close all connections.

        Args:
            grace: s that calls have to end by themselves.
        """
        self.close()
        for connection in tuple(self._open):
            connection.announce_end()
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(grace):
                while tasks := [task for connection in self._open for task in connection.calls.tasks]:
                    await asyncio.wait(tasks)
        tasks = [task for connection in self._open for task in connection.calls.tasks]
        tasks += [task for task in self._open.values() if not task.done()]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        for end in (Connection.say_goodbye, Connection.abort):
            for connection in tuple(self._open):
                end(connection)
            await asyncio.sleep(0)
        if self._paused is not None:
            self._paused.cancel()
        await asyncio.sleep(0)  # transports report one turn later that they are closed


def _is_gone(accepted: socket.socket) -> bool:
    """Return whether the client has closed a new connection without sending anything."""
    try:
        return accepted.recv(1, socket.MSG_PEEK) == b""
    except BlockingIOError:
        return False
    except OSError:
        return True
