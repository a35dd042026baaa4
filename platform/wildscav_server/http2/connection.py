"""The connections at one address: which are accepted, how they are read and written, and when they end.

Connections and their listener need each other: they share a buffer and the time of unknown clients.
"""

import asyncio
import contextlib
import socket
import ssl
import time
from collections.abc import Callable, Mapping, Sequence
from typing import cast

from wildscav.wire.errors import ProtocolRefusalError
from wildscav_server.http2.accounting import (
    CONNECTION_COST,
    GONE_COST,
    PAYLOAD_PER_FRAME,
    Account,
    FloodError,
    TimeShare,
)
from wildscav_server.http2.encryption import CHUNK, Encryption
from wildscav_server.http2.frames import Code, FrameError, Kind, write_frame
from wildscav_server.http2.session import SETTINGS, Route, Session

HANDSHAKE_TIMEOUT = 10.0  # s that a new client has to begin HTTP/2
IDLE_TIMEOUT = 60.0  # s that a connection may have no call
PING_AFTER = 30.0  # s without data after which a client is pinged
REPLY_TIMEOUT = 10.0  # s that a client has to answer a ping, or to read the last data before it is closed
CHECK_INTERVAL = 5.0  # s between two checks of a connection's timeouts
UNKNOWN_READ_SIZE = 4096  # bytes read at a time from an unknown client
BACKLOG = 1024  # connections that wait to be accepted
AT_ONCE = 16  # connections accepted before other work gets its turn
OUT_OF_FILES = 1.0  # s to wait when the system has no resources for a connection


class Connection(asyncio.BufferedProtocol):
    """The connection of one client, whose host is "" if it is not known."""

    def __init__(self, listener: "Listener", peer: str) -> None:
        self._listener, self.peer, self._tls = listener, peer, listener.tls
        self._encryption: Encryption | None = None  # created when the first bytes arrive
        self._loop = asyncio.get_running_loop()
        self._account = Account(self.send, on_known=lambda: listener.known(self))
        self.session = Session(self._account, listener.routes)
        self._deferred = b""  # data that was read but not processed yet
        self._closing = False
        self._transport: asyncio.Transport | None = None
        self._last_data = self._loop.time()  # when data last arrived
        self._pinged = 0.0  # when the client was pinged; 0 if no answer is due
        self._timer: asyncio.TimerHandle | None = None

    # The interface for the transport.

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Send the server's settings; with TLS, they are sent after the handshake."""
        self._transport = cast(asyncio.Transport, transport)
        if self._closing:  # it was evicted while it was set up
            self._transport.abort()
            return
        if self._tls is None:
            self.send(SETTINGS)
        self._timer = self._loop.call_later(HANDSHAKE_TIMEOUT, self._check_timeouts)

    def get_buffer(self, sizehint: int) -> memoryview:  # noqa: ARG002 - as asyncio calls it
        """Return the buffer to read into."""
        buffer = self._listener.buffer
        return buffer if self._account.known else buffer[:UNKNOWN_READ_SIZE]

    def buffer_updated(self, nbytes: int) -> None:
        """Process the data that was read, or defer it until unknown clients have time."""
        content = bytes(self._listener.buffer[:nbytes])
        if self._account.known:
            self._take(content)
        elif self._listener.share.wait() > 0.0:
            self._deferred += content
            self._pause()
        else:
            self._take_from_unknown(content)

    def eof_received(self) -> None:
        """Close the connection, because asyncio closes it if this returns None."""

    def pause_writing(self) -> None:
        """Stop writing, because the client does not read."""
        self._account.full = True

    def resume_writing(self) -> None:
        """Continue writing."""
        self._account.full = False
        self._account.wake()

    def connection_lost(self, error: Exception | None) -> None:  # noqa: ARG002
        """End all calls."""
        self._closing, self._transport = True, None
        if self._timer is not None:
            self._timer.cancel()
        self.session.abort()
        self._listener.closed(self)

    # Data from the client.

    def _take(self, content: bytes) -> None:
        if self._closing:
            return
        self._last_data, self._pinged = self._loop.time(), 0.0
        try:
            self.session.take(content if self._tls is None else self._decrypted(content, self._tls))
            if self._encryption is not None and self._encryption.has_ended:
                self.abort()
        except FrameError as error:
            self._refuse(error)
        except ssl.SSLError:
            self.abort()

    def _decrypted(self, content: bytes, tls: ssl.SSLContext) -> bytes:
        """Return the content of TLS records; their overhead is charged like frames without a message."""
        encryption = self._encryption = self._encryption or Encryption(tls)
        was_ready = encryption.is_ready
        try:
            plain = encryption.decrypt(content)
        finally:
            if self._transport is not None and (pending := encryption.pending_output()):
                self._transport.write(pending)
        if was_ready:
            self._account.spend((len(content) - len(plain)) / PAYLOAD_PER_FRAME)
        elif encryption.is_ready:
            self.send(SETTINGS)
        return plain

    def _take_from_unknown(self, content: bytes) -> None:
        started = time.thread_time()
        self._take(content)
        self._listener.share.spend(time.thread_time() - started)

    def _pause(self) -> None:
        if self._transport is not None:
            self._transport.pause_reading()
            self._listener.wait(self)

    def resume(self) -> None:
        """Process deferred data, and continue reading."""
        deferred, self._deferred = self._deferred, b""
        self._take_from_unknown(deferred)
        if self._transport is not None and not self._transport.is_closing():
            self._transport.resume_reading()

    def _refuse(self, error: FrameError) -> None:
        """Close the connection because of a protocol violation, and refuse all its calls."""
        reason = "FLOOD" if isinstance(error, FloodError) else "PROTOCOL_ERROR"
        self.session.abort(ProtocolRefusalError(reason, str(error)))
        self.close(error.code, str(error))
        if isinstance(error, FloodError):
            self._listener.flooded(error)

    def send(self, content: bytes) -> None:
        """Write data, unless the connection is closed."""
        if self._transport is None or self._transport.is_closing():
            return
        if self._tls is None:
            self._transport.write(content)
        elif self._encryption is not None and self._encryption.is_ready:
            self._transport.write(self._encryption.encrypt(content))

    # Its end.

    def _check_timeouts(self) -> None:
        """Close the connection if a timeout has passed; else ping a silent client, and check again later."""
        now = self._loop.time()
        if self.session:
            self.session.last_open = now
        if not self.session.has_settings or (self._pinged and now - self._pinged > REPLY_TIMEOUT):
            self.abort()
            return
        if now - self.session.last_open > IDLE_TIMEOUT:
            self.close(Code.NO_ERROR)
            return
        if now - self._last_data > PING_AFTER and not self._pinged:
            self._pinged = now
            self.send(write_frame(Kind.PING, 0, 0, b"wildscav"))
        self._timer = self._loop.call_later(CHECK_INTERVAL, self._check_timeouts)

    def close(self, code: Code, reason: str = "") -> None:
        """Send GOAWAY, and close the connection once everything is written."""
        self._closing = True
        if self._transport is not None:
            self.send(self.session.goodbye(code, reason))
            if self._encryption is not None and self._encryption.is_ready:
                self._transport.write(self._encryption.end())
            self._transport.close()
            self._loop.call_later(REPLY_TIMEOUT, self.abort)  # in case the client does not read

    def abort(self) -> None:
        """Close at once."""
        self._closing = True
        if self._transport is not None:
            self._transport.abort()


class Listener:
    """Accepts and counts connections.

    A client is unknown until a call on its connection has joined a seat or authenticated an organizer. When
    there are too many connections, the oldest one of the peer with the most unknown clients is closed. All
    unknown clients together have a share of the loop's time; when it is used up, none of them is accepted or
    read for a while.

    Args:
        sockets: Bound sockets; they are closed with the listener.
        max_total_connections: How many connections are accepted in all; None for any number. A number means
            that all of them come from one agent.
        on_flood: Called with what that agent did when no more connections are accepted from it.
    """

    def __init__(
        self,
        sockets: Sequence[socket.socket],
        routes: Mapping[str, Route],
        *,
        connections: int,
        max_total_connections: int | None = None,
        on_flood: Callable[[str], None] = lambda _: None,
        tls: ssl.SSLContext | None = None,
    ) -> None:
        self.routes, self._sockets, self.tls = routes, list(sockets), tls
        self._limit, self._total_limit, self._on_flood = connections, max_total_connections, on_flood
        self._total = 0
        self._loop = asyncio.get_running_loop()
        self.share = TimeShare(self._loop.time)
        self.buffer = memoryview(bytearray(CHUNK))
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
            if not self._count():
                accepted.close()
                return
            self._add(accepted, str(address[0]) if isinstance(address, tuple) else "")

    def _count(self) -> bool:
        """Count a new connection, and return whether it is within the limit of this address."""
        if self._total_limit is None:
            return True
        self._total += 1
        if self._total > self._total_limit:
            self._stop_accepting(f"flooded its socket with more than {self._total_limit} connections")
        return self._total <= self._total_limit

    def _stop_accepting(self, reason: str) -> None:
        self.close()
        self._on_flood(reason)

    def flooded(self, error: FloodError) -> None:
        """Accept no more connections, if all of them come from one agent."""
        if self._total_limit is not None and self._sockets:
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
        connection = Connection(self, peer)
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
        """Close all connections, once calls had ``grace`` seconds to end by themselves."""
        self.close()
        for connection in tuple(self._open):
            connection.session.announce_end()
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(grace):
                while tasks := [task for connection in self._open for task in connection.session.tasks]:
                    await asyncio.wait(tasks)
        tasks = [task for connection in self._open for task in connection.session.tasks]
        tasks += [task for task in self._open.values() if not task.done()]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        for connection in tuple(self._open):
            connection.close(Code.NO_ERROR)
        await asyncio.sleep(0)
        for connection in tuple(self._open):
            connection.abort()
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
