"""One client's connection: when it is read and written, how long it may last, and how it ends."""

import asyncio
import ssl
from collections.abc import Mapping
from typing import Protocol, cast

from wildscav.server.http2.allowance import HEAVY, Allowance, FloodError, Share, processor_time
from wildscav.server.http2.calls import STREAMS, Calls, Route
from wildscav.server.http2.encryption import Encryption
from wildscav.server.http2.flow_control import WINDOW, FlowControl
from wildscav.server.http2.frames import Code, FrameError, Kind, Setting, write_frame, write_settings
from wildscav.server.http2.inbound import HEADER_LIMIT, Inbound
from wildscav.wire.errors import ProtocolRefusalError

GREETING_TIME = 10.0  # s until a new connection must have spoken HTTP/2
IDLE_TIME = 60.0  # s that a connection may be without a call
SILENCE = 30.0  # s without a word after which a client is asked whether it is there
SIGN_TIME = 10.0  # s that it has to answer
LOOK = 5.0  # s between two looks at a connection's times
SIP = 4096  # bytes read at a time of an unknown client
GREETING = write_settings(
    {
        Setting.MAX_CONCURRENT_STREAMS: STREAMS,
        Setting.INITIAL_WINDOW_SIZE: WINDOW,
        Setting.MAX_HEADER_LIST_SIZE: HEADER_LIMIT,
    }
)


class Host(Protocol):
    """What a connection belongs to."""

    routes: Mapping[str, Route]
    share: Share  # of all unknown clients together
    buffer: memoryview  # what is read goes through it; nothing is in it between two reads

    def wait(self, connection: "Connection") -> None:
        """Have an unknown client wait, unread, until unknown clients have time again."""
        ...

    def flooded(self, error: FloodError) -> None:
        """Hear that a client has gone beyond what it may cost."""
        ...

    def known(self, connection: "Connection") -> None:
        """Count a connection no longer among the unknown clients'."""
        ...

    def closed(self, connection: "Connection") -> None:
        """Forget a connection."""
        ...


class Connection(asyncio.BufferedProtocol):
    """One client's connection.

    Args:
        host: What it belongs to.
        peer: Where it comes from, as far as that is known.
        tls: How it is encrypted; it is not if none.
    """

    def __init__(self, host: Host, peer: str, tls: ssl.SSLContext | None = None) -> None:
        self._host, self.peer, self._tls = host, peer, tls
        self._encryption: Encryption | None = None  # from the first bytes on
        self._loop = asyncio.get_running_loop()
        self.allowance = Allowance(self._loop.time)
        self.known = False  # whether the client is in a seat, or an organizer
        self.flow = FlowControl(self.send)
        self.calls = Calls(self, host.routes)
        self._inbound = Inbound(self)
        self._kept = b""  # what was read and not looked at
        self._closing = False
        self._transport: asyncio.Transport | None = None
        self._heard = self._loop.time()  # when anything came
        self._asked = 0.0  # when the client was asked whether it is there; 0: it need not answer
        self._timer: asyncio.TimerHandle | None = None

    @property
    def is_over(self) -> bool:
        """Whether nothing that comes matters any more."""
        return self._closing or self._transport is None

    # What the transport calls.

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Greet the client; where the connection is to be encrypted, this waits for the handshake."""
        self._transport = cast(asyncio.Transport, transport)
        if self._closing:  # it had to make room meanwhile
            self._transport.abort()
            return
        if self._tls is None:
            self.send(GREETING)
        self._timer = self._loop.call_later(GREETING_TIME, self._look)

    def get_buffer(self, sizehint: int) -> memoryview:  # noqa: ARG002 - as asyncio calls it
        """Return where to put what is read."""
        return self._host.buffer if self.known else self._host.buffer[:SIP]

    def buffer_updated(self, nbytes: int) -> None:
        """Take what was read, or keep it until unknown clients have time."""
        content = bytes(self._host.buffer[:nbytes])
        if self.known:
            self._take(content)
        elif self._host.share.wait() > 0.0:
            self._kept += content
            self._pause()
        else:
            self._take_from_unknown(content)

    def eof_received(self) -> None:
        """Close: who says no more on a connection hears no more."""

    def pause_writing(self) -> None:
        """Write no more for now: the client does not read."""
        self.flow.full = True

    def resume_writing(self) -> None:
        """Write again."""
        self.flow.full = False
        self.flow.wake()

    def connection_lost(self, error: Exception | None) -> None:  # noqa: ARG002
        """End all calls."""
        self._closing, self._transport = True, None
        if self._timer is not None:
            self._timer.cancel()
        self.calls.break_off()
        self._host.closed(self)

    # What the client sends.

    def _take(self, content: bytes) -> None:
        if self.is_over:
            return
        self._heard, self._asked = self._loop.time(), 0.0
        try:
            self._inbound.take(content if self._tls is None else self._decrypted(content, self._tls))
            if self._encryption is not None and self._encryption.has_ended:
                self.abort()
        except FrameError as error:
            self._refuse(error)
        except ssl.SSLError:
            self.abort()

    def _decrypted(self, content: bytes, tls: ssl.SSLContext) -> bytes:
        """Return what is in TLS's records; what they add to it is paid for like frames without a message.

        Raises:
            ssl.SSLError: It is not TLS, or not from a client that may come in.
            FloodError: There is too little in the records.
        """
        encryption = self._encryption = self._encryption or Encryption(tls)
        was_ready = encryption.is_ready
        try:
            plain = encryption.decrypt(content)
        finally:
            if self._transport is not None and (own := encryption.own_words()):
                self._transport.write(own)
        if was_ready:
            self.allowance.spend((len(content) - len(plain)) / HEAVY)
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
        """Take what was kept, and read again."""
        kept, self._kept = self._kept, b""
        self._take_from_unknown(kept)
        if self._transport is not None and not self._transport.is_closing():
            self._transport.resume_reading()

    def _refuse(self, error: FrameError) -> None:
        """Close the connection: of what is on it, the client is to blame for all."""
        reason = "FLOOD" if isinstance(error, FloodError) else "PROTOCOL_ERROR"
        self.calls.break_off(ProtocolRefusalError(reason, str(error)))
        self.close(error.code, str(error))
        if isinstance(error, FloodError):
            self._host.flooded(error)

    # What calls do.

    def send(self, content: bytes) -> None:
        """Write something, if anybody is there."""
        if self._transport is None or self._transport.is_closing():
            return
        if self._tls is None:
            self._transport.write(content)
        elif self._encryption is not None and self._encryption.is_ready:
            self._transport.write(self._encryption.encrypt(content))

    def trust(self) -> None:
        """Count the connection as known: it no longer shares the time of unknown clients."""
        if not self.known:
            self.known = True
            self.allowance.widen()
            self._host.known(self)

    # Its times.

    def _look(self) -> None:
        """Close the connection if it is of no use any more; else look again."""
        now = self._loop.time()
        if self.calls:
            self.calls.served = now
        if not self._inbound.greeted or (self._asked and now - self._asked > SIGN_TIME):
            self.abort()
            return
        if now - self.calls.served > IDLE_TIME:
            self.say_goodbye()
            return
        if now - self._heard > SILENCE and not self._asked:
            self._asked = now
            self.send(write_frame(Kind.PING, 0, 0, b"wildscav"))
        self._timer = self._loop.call_later(LOOK, self._look)

    # Its end.

    def announce_end(self) -> None:
        """Say that no new call is served."""
        self.send(_goaway(self.calls.last, Code.NO_ERROR))

    def say_goodbye(self) -> None:
        """Close the connection, nothing being wrong with it."""
        self.close(Code.NO_ERROR)

    def close(self, code: Code, reason: str = "") -> None:
        """Say goodbye and close, as soon as what was written has gone."""
        self._closing = True
        if self._transport is not None:
            self.send(_goaway(self.calls.last, code, reason))
            if self._encryption is not None and self._encryption.is_ready:
                self._transport.write(self._encryption.end())
            self._transport.close()
            self._loop.call_later(SIGN_TIME, self.abort)  # who does not read, does not keep it open

    def abort(self) -> None:
        """Close at once."""
        self._closing = True
        if self._transport is not None:
            self._transport.abort()


def _goaway(last: int, code: Code, reason: str = "") -> bytes:
    payload = last.to_bytes(4, "big") + code.to_bytes(4, "big") + reason.encode()
    return write_frame(Kind.GOAWAY, 0, 0, payload)
