"""One client's connection: reading and writing, timeouts, and closing."""

import asyncio
import ssl
from collections.abc import Mapping
from typing import Protocol, cast

from wildscav.wire.errors import ProtocolRefusalError
from wildscav_server.http2.allowance import (
    PAYLOAD_PER_FRAME,
    Allowance,
    FloodError,
    TimeShare,
    processor_time,
)
from wildscav_server.http2.calls import STREAMS, Calls, Route
from wildscav_server.http2.encryption import Encryption
from wildscav_server.http2.flow_control import WINDOW, FlowControl
from wildscav_server.http2.frames import Code, FrameError, Kind, Setting, write_frame, write_settings
from wildscav_server.http2.inbound import HEADER_LIMIT, Inbound

HANDSHAKE_TIMEOUT = 10.0  # s that a new client has to begin HTTP/2
IDLE_TIMEOUT = 60.0  # s that a connection may have no call
PING_AFTER = 30.0  # s without data after which a client is pinged
REPLY_TIMEOUT = 10.0  # s that a client has to answer a ping, or to read the last data before it is closed
CHECK_INTERVAL = 5.0  # s between two checks of a connection's timeouts
UNKNOWN_READ_SIZE = 4096  # bytes read at a time from an unknown client
GREETING = write_settings(
    {
        Setting.MAX_CONCURRENT_STREAMS: STREAMS,
        Setting.INITIAL_WINDOW_SIZE: WINDOW,
        Setting.MAX_HEADER_LIST_SIZE: HEADER_LIMIT,
    }
)


class Host(Protocol):
    """The interface of the listener that a connection belongs to."""

    routes: Mapping[str, Route]
    share: TimeShare  # of all unknown clients together
    buffer: memoryview  # shared buffer for reading; unused between two reads

    def wait(self, connection: "Connection") -> None:
        """Leave an unknown client's data unread until unknown clients have time again."""
        ...

    def flooded(self, error: FloodError) -> None:
        """Note that a client has exceeded its limits."""
        ...

    def known(self, connection: "Connection") -> None:
        """Remove a connection from those of unknown clients."""
        ...

    def closed(self, connection: "Connection") -> None:
        """Remove a connection that is closed."""
        ...


class Connection(asyncio.BufferedProtocol):
    """One client's connection.

    Args:
        host: The listener.
        peer: The client's host, "" if it is not known.
        tls: TLS settings; None if the connection is not encrypted.
    """

    def __init__(self, host: Host, peer: str, tls: ssl.SSLContext | None = None) -> None:
        self._host, self.peer, self._tls = host, peer, tls
        self._encryption: Encryption | None = None  # created when the first bytes arrive
        self._loop = asyncio.get_running_loop()
        self.allowance = Allowance(self._loop.time)
        self.known = False  # whether the client is in a seat, or an organizer
        self.flow = FlowControl(self.send)
        self.calls = Calls(self, host.routes)
        self._inbound = Inbound(self)
        self._deferred = b""  # data that was read but not processed yet
        self._closing = False
        self._transport: asyncio.Transport | None = None
        self._last_data = self._loop.time()  # when data last arrived
        self._pinged = 0.0  # when the client was pinged; 0 if no answer is due
        self._timer: asyncio.TimerHandle | None = None

    @property
    def is_over(self) -> bool:
        """Whether the connection is closing or closed, so that further data is ignored."""
        return self._closing or self._transport is None

    # The interface for the transport.

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Send the server's settings; with TLS, they are sent after the handshake."""
        self._transport = cast(asyncio.Transport, transport)
        if self._closing:  # it was evicted while it was set up
            self._transport.abort()
            return
        if self._tls is None:
            self.send(GREETING)
        self._timer = self._loop.call_later(HANDSHAKE_TIMEOUT, self._check_timeouts)

    def get_buffer(self, sizehint: int) -> memoryview:  # noqa: ARG002 - as asyncio calls it
        """Return the buffer to read into."""
        return self._host.buffer if self.known else self._host.buffer[:UNKNOWN_READ_SIZE]

    def buffer_updated(self, nbytes: int) -> None:
        """Process the data that was read, or defer it until unknown clients have time."""
        content = bytes(self._host.buffer[:nbytes])
        if self.known:
            self._take(content)
        elif self._host.share.wait() > 0.0:
            self._deferred += content
            self._pause()
        else:
            self._take_from_unknown(content)

    def eof_received(self) -> None:
        """Close the connection, because asyncio closes it if this returns None."""

    def pause_writing(self) -> None:
        """Stop writing, because the client does not read."""
        self.flow.full = True

    def resume_writing(self) -> None:
        """Continue writing."""
        self.flow.full = False
        self.flow.wake()

    def connection_lost(self, error: Exception | None) -> None:  # noqa: ARG002
        """End all calls."""
        self._closing, self._transport = True, None
        if self._timer is not None:
            self._timer.cancel()
        self.calls.abort()
        self._host.closed(self)

    # Data from the client.

    def _take(self, content: bytes) -> None:
        if self.is_over:
            return
        self._last_data, self._pinged = self._loop.time(), 0.0
        try:
            self._inbound.take(content if self._tls is None else self._decrypted(content, self._tls))
            if self._encryption is not None and self._encryption.has_ended:
                self.abort()
        except FrameError as error:
            self._refuse(error)
        except ssl.SSLError:
            self.abort()

    def _decrypted(self, content: bytes, tls: ssl.SSLContext) -> bytes:
        """Return the content of TLS records; their overhead is charged like frames without a message.

        Raises:
            ssl.SSLError: The data is not valid TLS, or the client's certificate is not accepted.
            FloodError: The records have too much overhead.
        """
        encryption = self._encryption = self._encryption or Encryption(tls)
        was_ready = encryption.is_ready
        try:
            plain = encryption.decrypt(content)
        finally:
            if self._transport is not None and (pending := encryption.pending_output()):
                self._transport.write(pending)
        if was_ready:
            self.allowance.spend((len(content) - len(plain)) / PAYLOAD_PER_FRAME)
        elif encryption.is_ready:
            self.send(GREETING)
        return plain

    def _take_from_unknown(self, content: bytes) -> None:
        started = processor_time()
        self._take(content)
        self._host.share.spend(processor_time() - started)

    def _pause(self) -> None:
        if self._transport is not None:
            self._transport.pause_reading()
            self._host.wait(self)

    def resume(self) -> None:
        """Process deferred data, and continue reading."""
        deferred, self._deferred = self._deferred, b""
        self._take_from_unknown(deferred)
        if self._transport is not None and not self._transport.is_closing():
            self._transport.resume_reading()

    def _refuse(self, error: FrameError) -> None:
        """Close the connection because of a protocol violation, and refuse all its calls."""
        reason = "FLOOD" if isinstance(error, FloodError) else "PROTOCOL_ERROR"
        self.calls.abort(ProtocolRefusalError(reason, str(error)))
        self.close(error.code, str(error))
        if isinstance(error, FloodError):
            self._host.flooded(error)

    # The interface for calls.

    def send(self, content: bytes) -> None:
        """Write data, unless the connection is closed."""
        if self._transport is None or self._transport.is_closing():
            return
        if self._tls is None:
            self._transport.write(content)
        elif self._encryption is not None and self._encryption.is_ready:
            self._transport.write(self._encryption.encrypt(content))

    def trust(self) -> None:
        """Mark the client as known: it no longer uses the time of unknown clients."""
        if not self.known:
            self.known = True
            self.allowance.raise_limit()
            self._host.known(self)

    # Its timeouts.

    def _check_timeouts(self) -> None:
        """Close the connection if a timeout has passed; else ping a silent client, and check again later."""
        now = self._loop.time()
        if self.calls:
            self.calls.last_open = now
        if not self._inbound.has_settings or (self._pinged and now - self._pinged > REPLY_TIMEOUT):
            self.abort()
            return
        if now - self.calls.last_open > IDLE_TIMEOUT:
            self.say_goodbye()
            return
        if now - self._last_data > PING_AFTER and not self._pinged:
            self._pinged = now
            self.send(write_frame(Kind.PING, 0, 0, b"wildscav"))
        self._timer = self._loop.call_later(CHECK_INTERVAL, self._check_timeouts)

    # Its end.

    def announce_end(self) -> None:
        """Tell the client that new calls are not served."""
        self.send(_goaway(self.calls.last, Code.NO_ERROR))

    def say_goodbye(self) -> None:
        """Close the connection without an error."""
        self.close(Code.NO_ERROR)

    def close(self, code: Code, reason: str = "") -> None:
        """Send GOAWAY, and close the connection once everything is written."""
        self._closing = True
        if self._transport is not None:
            self.send(_goaway(self.calls.last, code, reason))
            if self._encryption is not None and self._encryption.is_ready:
                self._transport.write(self._encryption.end())
            self._transport.close()
            self._loop.call_later(REPLY_TIMEOUT, self.abort)  # in case the client does not read

    def abort(self) -> None:
        """Close at once."""
        self._closing = True
        if self._transport is not None:
            self._transport.abort()


def _goaway(last: int, code: Code, reason: str = "") -> bytes:
    payload = last.to_bytes(4, "big") + code.to_bytes(4, "big") + reason.encode()
    return write_frame(Kind.GOAWAY, 0, 0, payload)
