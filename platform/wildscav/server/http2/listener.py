"""The listener at one address: who is let in, how many, and how fast."""

import asyncio
import contextlib
import socket
import ssl
from collections.abc import Callable, Mapping, Sequence

from wildscav.server.http2.allowance import CONNECTION_COST, GONE_COST, FloodError, Share
from wildscav.server.http2.calls import Route
from wildscav.server.http2.connection import Connection

BACKLOG = 1024  # connections that wait to be let in
AT_ONCE = 16  # connections let in before others get their turn
OUT_OF_FILES = 1.0  # s to wait when the system has no room for a connection


class Listener:
    """Lets connections in, and keeps count of them.

    A client is unknown until a call on its connection has named a seat or an organizer. When there are too
    many connections, the peer with the most unknown clients loses its oldest one. All unknown clients
    together have a share of the loop's time; when they have used it up, none of them is accepted or read for
    a while.

    Args:
        sockets: Bound; they are closed with the listener.
        routes: What each method is served by.
        connections: How many may be open at one time.
        visits: How many may ever come; any number if none. If it is given, all who come are one agent.
        on_flood: Called with what that agent did when no more connections of it are accepted.
        tls: How connections are encrypted; they are not if none.
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
        self.share = Share(self._loop.time)
        self.buffer = memoryview(bytearray(65_536))
        self._waiting: dict[Connection, None] = {}  # unknown clients, until there is time for them
        self._open: dict[Connection, asyncio.Task[None]] = {}  # each with what sets it up
        self._unknown: dict[str, dict[Connection, None]] = {}  # by peer, in the order in which they came
        self._paused: asyncio.TimerHandle | None = None  # ends a pause for unknown clients
        self._accepts_next = False  # whether the last turn was that of new connections

    def start(self) -> None:
        """Let connections in."""
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

    def _accept(self, at: socket.socket, most: int = AT_ONCE) -> None:
        for _ in range(most):
            if not self._sockets:
                return
            if (seconds := self.share.wait()) > 0.0:
                self._pause(seconds)
                return
            try:
                come, address = at.accept()
            except (BlockingIOError, InterruptedError, ConnectionAbortedError):
                return
            except OSError:  # no more files, or no memory
                self._pause(OUT_OF_FILES)
                return
            if not self._count_visit():
                come.close()
                return
            self._welcome(come, str(address[0]) if isinstance(address, tuple) else "")

    def _count_visit(self) -> bool:
        """Count who comes; return whether it is not one too many for this address."""
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
        """Let nobody in any more, if all who come are one agent."""
        if self._visit_limit is not None and self._sockets:
            self._stop_accepting(str(error))

    def _welcome(self, come: socket.socket, peer: str) -> None:
        """Set a connection up, unless whoever came has gone already."""
        come.setblocking(False)
        if _is_gone(come):
            self.share.spend(GONE_COST)
            come.close()
            return
        self.share.spend(CONNECTION_COST)
        if len(self._open) >= self._limit and not self._evict_unknown():
            come.close()
            return
        if come.family != socket.AF_UNIX:
            come.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        connection = Connection(self, peer, self._tls)
        self._unknown.setdefault(peer, {})[connection] = None
        task = self._loop.create_task(self._set_up(connection, come), name="connection")
        # One that was cancelled before it began has closed nothing.
        task.add_done_callback(lambda done: come.close() if done.cancelled() else None)
        self._open[connection] = task

    async def _set_up(self, connection: Connection, come: socket.socket) -> None:
        """Connect a socket to what serves it."""
        try:
            await self._loop.connect_accepted_socket(lambda: connection, come)
        except OSError:
            come.close()
            self.closed(connection)

    def _evict_unknown(self) -> bool:
        """Close an unknown client's connection; return whether there was one."""
        if not self._unknown:
            return False
        of_peer = max(self._unknown.values(), key=len)
        one = next(iter(of_peer))
        self._open[one].cancel()  # if it is still being set up
        one.abort()
        self.closed(one)
        return True

    # What connections tell.

    def known(self, connection: Connection) -> None:
        """Count a connection no longer among the unknown clients'."""
        of_peer = self._unknown.get(connection.peer, {})
        of_peer.pop(connection, None)
        if not of_peer:
            self._unknown.pop(connection.peer, None)

    def closed(self, connection: Connection) -> None:
        """Forget a connection."""
        self._open.pop(connection, None)
        self._waiting.pop(connection, None)
        self.known(connection)

    def wait(self, connection: Connection) -> None:
        """Have an unknown client wait until unknown clients have time again."""
        self._waiting[connection] = None
        self._pause(self.share.wait())

    def _pause(self, seconds: float) -> None:
        """Do nothing for unknown clients for a while."""
        if self._paused is None:
            self._stop_listening()
            self._paused = self._loop.call_later(seconds, self._go_on)

    def _go_on(self) -> None:
        """Take turns between what unknown clients have sent, oldest first, and new connections.

        So neither keeps the other waiting for ever, even if there is time for one of them only.
        """
        self._paused = None
        while self._waiting and self.share.wait() == 0.0:
            self._accepts_next = not self._accepts_next
            if self._accepts_next:
                for at in tuple(self._sockets):
                    self._accept(at, most=1)
            else:
                one = next(iter(self._waiting))
                del self._waiting[one]
                one.resume()
        if (seconds := self.share.wait()) > 0.0:
            self._pause(seconds)
        elif self._paused is None:
            self._listen()

    # Its end.

    def close(self) -> None:
        """Let nobody in any more; who is in, stays."""
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
        await asyncio.sleep(0)  # transports tell one turn later that they are closed


def _is_gone(come: socket.socket) -> bool:
    """Return whether the other end of a new connection is closed, with nothing said before."""
    try:
        return come.recv(1, socket.MSG_PEEK) == b""
    except BlockingIOError:
        return False
    except OSError:
        return True
