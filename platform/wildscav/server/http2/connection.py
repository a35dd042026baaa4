"""One connection: what a client sends is taken apart here, counted, and handed to the calls on it."""

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from typing import NamedTuple, Protocol, cast

from hpack import Decoder, HPACKError

from wildscav.server.http2.allowance import (
    HEADERS_COST,
    HEAVY,
    Allowance,
    FloodError,
    Share,
    processor_time,
)
from wildscav.server.http2.frames import (
    FIRST_WINDOW,
    LARGEST,
    LARGEST_WINDOW,
    Code,
    Flag,
    Frame,
    FrameError,
    FrameReader,
    Kind,
    Setting,
    read_settings,
    without_padding,
    write_frame,
    write_settings,
)
from wildscav.server.http2.stream import WINDOW, Stream, StreamLostError
from wildscav.wire.errors import ProtocolRefusalError, RefusalError

STREAMS = 128  # at one time
HEADER_LIMIT = 16_384  # bytes of the headers of a call, packed and unpacked
UNKNOWN_LIMIT = 32_768  # bytes of messages that a client may send before it is known
GREETING_TIME = 10.0  # s until a new connection must have spoken HTTP/2
IDLE_TIME = 60.0  # s that a connection may be without a call
SILENCE = 30.0  # s without a word after which a client is asked whether it is there
SIGN_TIME = 10.0  # s that it has to answer
LOOK = 5.0  # s between two looks at a connection's times
SIP = 4096  # bytes read at a time of a connection of which nobody knows whose it is
UNIMPLEMENTED, UNAVAILABLE = 12, 14  # statuses of gRPC
GREETING = write_settings(
    {
        Setting.MAX_CONCURRENT_STREAMS: STREAMS,
        Setting.INITIAL_WINDOW_SIZE: WINDOW,
        Setting.MAX_HEADER_LIST_SIZE: HEADER_LIMIT,
    }
)


class Route(NamedTuple):
    """What a method is served by."""

    handle: Callable[[Stream], Awaitable[None]]
    limit: int = 4096  # bytes of a message
    admit: Callable[[Stream], None] | None = None  # raises RefusalError for whom it is not


class Host(Protocol):
    """What a connection belongs to."""

    routes: Mapping[str, Route]
    share: Share  # of all strangers together
    buffer: memoryview  # what is read goes through it; nothing is in it between two reads

    def wait(self, connection: "Connection") -> None:
        """Have a stranger wait, not being read, until strangers have time again."""
        ...

    def flooded(self, error: FloodError) -> None:
        """Hear that a client has gone beyond what it may cost."""
        ...

    def known(self, connection: "Connection") -> None:
        """Count a connection no longer among the strangers'."""
        ...

    def closed(self, connection: "Connection") -> None:
        """Forget a connection."""
        ...


class Connection(asyncio.BufferedProtocol):
    """One client's connection.

    Args:
        host: What it belongs to.
        peer: Where it comes from, as far as that is known.
    """

    def __init__(self, host: Host, peer: str) -> None:
        self._host, self.peer = host, peer
        self._loop = asyncio.get_running_loop()
        self.allowance = Allowance(self._loop.time)
        self.known = False  # whether the client is in a seat, or an organizer
        self.window = FIRST_WINDOW  # bytes that the client takes
        self.full = False  # whether nothing more is to be written until some has gone
        self._reader, self._decoder = FrameReader(), Decoder(HEADER_LIMIT)
        self._streams: dict[int, Stream] = {}
        self._last = 0  # number of the last stream that was begun
        self._headers: bytearray | None = None  # of a call that is not all there
        self._headers_of = Frame(0, 0, 0, b"")  # the frame that they began with
        self._stream_window = FIRST_WINDOW  # bytes that the client takes of a new stream
        self._arrived = self._room = 0  # bytes: unread of the connection, and to be made room for
        self._kept = b""  # what was read and not looked at
        self._said = 0  # bytes of messages
        self._waiters: set[asyncio.Future[None]] = set()  # of those who wait for room
        self._closing = False
        self._greeted = False  # whether the client's SETTINGS came
        self._transport: asyncio.Transport | None = None
        self._heard = self._served = self._loop.time()  # when anything came, and when a call was last open
        self._asked = 0.0  # when the client was asked whether it is there; 0: it need not answer
        self._timer: asyncio.TimerHandle | None = None

    # What the transport calls.

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Greet the client."""
        self._transport = cast(asyncio.Transport, transport)
        if self._closing:  # it had to make room meanwhile
            self._transport.abort()
            return
        self.send(GREETING)
        self._timer = self._loop.call_later(GREETING_TIME, self._look)

    def get_buffer(self, sizehint: int) -> memoryview:  # noqa: ARG002 - as asyncio calls it
        """Return where to put what is read."""
        return self._host.buffer if self.known else self._host.buffer[:SIP]

    def buffer_updated(self, nbytes: int) -> None:
        """Take what was read, or keep it until strangers have time."""
        content = bytes(self._host.buffer[:nbytes])
        if self.known:
            self._take(content)
        elif self._host.share.wait() > 0.0:
            self._kept += content
            self._pause()
        else:
            self._take_from_stranger(content)

    def _take_from_stranger(self, content: bytes) -> None:
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
        self._take_from_stranger(kept)
        if self._transport is not None and not self._transport.is_closing():
            self._transport.resume_reading()

    def eof_received(self) -> None:
        """Close: who says no more on a connection hears no more."""

    def pause_writing(self) -> None:
        """Write no more for now: the client does not read."""
        self.full = True

    def resume_writing(self) -> None:
        """Write again."""
        self.full = False
        self._wake_writers()

    def connection_lost(self, error: Exception | None) -> None:  # noqa: ARG002
        """End all calls."""
        self._closing, self._transport = True, None
        if self._timer is not None:
            self._timer.cancel()
        self._break_off()
        self._host.closed(self)

    def _break_off(self, refusal: RefusalError | None = None) -> None:
        streams, self._streams = tuple(self._streams.values()), {}
        for stream in streams:
            stream.break_off(refusal)
        self._wake_writers()

    # What calls do.

    @property
    def tasks(self) -> list[asyncio.Task[None]]:
        """What serves the calls."""
        return [stream.task for stream in self._streams.values() if stream.task is not None]

    def send(self, content: bytes) -> None:
        """Write something, if anybody is there."""
        if self._transport is not None and not self._transport.is_closing():
            self._transport.write(content)

    async def room_for(self, stream: Stream) -> None:
        """Wait until there is room for some of a stream.

        Raises:
            StreamLostError: The connection is gone.
        """
        while self.full or self.window <= 0 or stream.window <= 0:
            if self._transport is None or stream.finished:
                raise StreamLostError
            waiter: asyncio.Future[None] = self._loop.create_future()
            self._waiters.add(waiter)
            try:
                await waiter
            finally:
                self._waiters.discard(waiter)

    def _wake_writers(self) -> None:
        for waiter in self._waiters:
            if not waiter.done():
                waiter.set_result(None)

    def make_room(self, size: int, stream: int) -> None:
        """Let the client send more.

        Args:
            size: Bytes that need no more place.
            stream: Of this stream, too; 0: of the connection alone.
        """
        self._arrived -= size
        self._room += size
        frames = write_frame(Kind.WINDOW_UPDATE, 0, stream, size.to_bytes(4, "big")) if stream else b""
        if self._room >= WINDOW:
            frames += write_frame(Kind.WINDOW_UPDATE, 0, 0, self._room.to_bytes(4, "big"))
            self._room = 0
        if frames:
            self.send(frames)

    def forget(self, stream: Stream) -> None:
        """Let go of a stream that has ended."""
        self._served = self._loop.time()
        if self._streams.pop(stream.number, None) is not None and stream.unread:
            self.make_room(stream.unread, 0)

    def trust(self) -> None:
        """Count the connection as known: it no longer shares the time of strangers."""
        if not self.known:
            self.known = True
            self.allowance.widen()
            self._host.known(self)

    # Its times.

    def _look(self) -> None:
        """Close the connection if it is of no use any more; else look again."""
        now = self._loop.time()
        if self._streams:
            self._served = now
        if not self._greeted or (self._asked and now - self._asked > SIGN_TIME):
            self.abort()
            return
        if now - self._served > IDLE_TIME:
            self.say_goodbye()
            return
        if now - self._heard > SILENCE and not self._asked:
            self._asked = now
            self.send(write_frame(Kind.PING, 0, 0, b"wildscav"))
        self._timer = self._loop.call_later(LOOK, self._look)

    def announce_end(self) -> None:
        """Say that no new call is served."""
        self.send(_goaway(self._last, Code.NO_ERROR))

    def say_goodbye(self) -> None:
        """Close the connection, nothing being wrong with it."""
        self.close(Code.NO_ERROR)

    def close(self, code: Code, reason: str = "") -> None:
        """Say goodbye and close, as soon as what was written has gone."""
        self._closing = True
        if self._transport is not None:
            self.send(_goaway(self._last, code, reason))
            self._transport.close()
            self._loop.call_later(SIGN_TIME, self.abort)  # who does not read, does not keep it open

    def abort(self) -> None:
        """Close at once."""
        self._closing = True
        if self._transport is not None:
            self._transport.abort()

    # What the client sends.

    def _take(self, content: bytes) -> None:
        if self._is_over():
            return
        self._heard, self._asked = self._loop.time(), 0.0
        try:
            for frame in self._reader.feed(content):
                self._take_frame(frame)
                if self._is_over():
                    return
        except FrameError as error:
            self._refuse(error)
        except HPACKError:
            self._refuse(FrameError(Code.COMPRESSION_ERROR, "sent headers that cannot be unpacked"))

    def _is_over(self) -> bool:
        return self._closing or self._transport is None

    def _refuse(self, error: FrameError) -> None:
        """Close the connection: of what is on it, the client is to blame for all."""
        reason = "FLOOD" if isinstance(error, FloodError) else "PROTOCOL_ERROR"
        self._break_off(ProtocolRefusalError(reason, str(error)))
        self.close(error.code, str(error))
        if isinstance(error, FloodError):
            self._host.flooded(error)

    def _take_frame(self, frame: Frame) -> None:
        kind = frame.kind
        if self._headers is not None and (
            kind != Kind.CONTINUATION or frame.stream != self._headers_of.stream
        ):
            raise FrameError(Code.PROTOCOL_ERROR, "sent something else in the middle of headers")
        if not self._greeted and kind != Kind.SETTINGS:
            raise FrameError(Code.PROTOCOL_ERROR, "did not begin with SETTINGS")
        if kind == Kind.DATA:
            self._data(frame)
            return
        cost = HEADERS_COST if kind == Kind.HEADERS else 1.0
        self.allowance.spend(cost + len(frame.payload) // HEAVY, _name(kind))
        take = _TAKE.get(kind)
        if take is not None:  # what is not known is ignored
            take(self, frame)

    def _data(self, frame: Frame) -> None:
        if frame.stream == 0 or frame.stream > self._last:
            raise FrameError(Code.PROTOCOL_ERROR, "sent data of no call")
        taken = len(frame.payload)
        self._arrived += taken
        self._said += taken
        if self._arrived > FIRST_WINDOW + WINDOW:
            raise FrameError(Code.FLOW_CONTROL_ERROR, "sent more than there was room for")
        if not self.known and self._said > UNKNOWN_LIMIT:
            raise FloodError(f"sent {self._said:,} bytes without saying who it is")
        content, stream = without_padding(frame), self._streams.get(frame.stream)
        complete = False
        if stream is None:
            self.make_room(taken, 0)
        else:
            complete = stream.feed(content, taken)
            if stream.unread > 2 * WINDOW:
                raise FrameError(Code.FLOW_CONTROL_ERROR, "sent more of a call than there was room for")
            if frame.flags & Flag.END_STREAM:
                self._half_close(stream)
        if not complete:
            self.allowance.spend(1.0, "DATA")

    def _half_close(self, stream: Stream) -> None:
        stream.ended_by_client = True
        stream.wake()

    def _begin_headers(self, frame: Frame) -> None:
        if frame.stream % 2 == 0:
            raise FrameError(Code.PROTOCOL_ERROR, "began a call with a number that is not a client's")
        self._headers, self._headers_of = bytearray(without_padding(frame)), frame
        if frame.flags & Flag.END_HEADERS:
            self._end_headers()

    def _continue_headers(self, frame: Frame) -> None:
        if self._headers is None:
            raise FrameError(Code.PROTOCOL_ERROR, "continued headers that it had not begun")
        self._headers += frame.payload
        if len(self._headers) > HEADER_LIMIT:
            raise FloodError(f"sent headers of more than {HEADER_LIMIT:,} bytes")
        if frame.flags & Flag.END_HEADERS:
            self._end_headers()

    def _end_headers(self) -> None:
        """Begin a call, or end one: what its client says after it began it is its end."""
        number, ends = self._headers_of.stream, bool(self._headers_of.flags & Flag.END_STREAM)
        packed, self._headers = bytes(self._headers or b""), None
        # All are unpacked, or later ones could not be.
        headers = {str(name): str(value) for name, value in self._decoder.decode(packed)}
        stream = self._streams.get(number)
        if stream is not None:
            if not ends:
                raise FrameError(Code.PROTOCOL_ERROR, "sent headers twice")
            self._half_close(stream)
        elif number > self._last:
            self._last = number
            self._begin(number, headers, ends=ends)

    def _begin(self, number: int, headers: Mapping[str, str], *, ends: bool) -> None:
        if len(self._streams) >= STREAMS:
            self.send(write_frame(Kind.RST_STREAM, 0, number, Code.REFUSED_STREAM.to_bytes(4, "big")))
            return
        route = self._host.routes.get(headers.get(":path", ""))
        stream = Stream(self, number, headers, self._stream_window, route.limit if route else 0)
        stream.ended_by_client = ends
        self._streams[number] = stream
        if route is None:
            stream.finish(code=UNIMPLEMENTED, details="there is no such method")
            return
        try:
            if route.admit is not None:
                route.admit(stream)
        except RefusalError as refusal:
            stream.finish(refusal)
            return
        stream.task = self._loop.create_task(_serve(route, stream), name="stream")

    def _reset(self, frame: Frame) -> None:
        _check_length(frame, 4)
        if frame.stream == 0 or frame.stream > self._last:
            raise FrameError(Code.PROTOCOL_ERROR, "ended a call that it had not begun")
        stream = self._streams.get(frame.stream)
        if stream is not None:
            self.forget(stream)
            stream.break_off()
            self._wake_writers()

    def _settings(self, frame: Frame) -> None:
        if frame.flags & Flag.ACK:
            return
        self._greeted = True
        for name, value in read_settings(frame.payload):
            if name == Setting.INITIAL_WINDOW_SIZE:
                self._change_window(value)
            elif name == Setting.MAX_FRAME_SIZE and not LARGEST <= value < 2**24:
                raise FrameError(Code.PROTOCOL_ERROR, f"asked for frames of {value:,} bytes")
        self.send(write_frame(Kind.SETTINGS, Flag.ACK, 0))

    def _change_window(self, size: int) -> None:
        if size > LARGEST_WINDOW:
            raise FrameError(Code.FLOW_CONTROL_ERROR, f"asked for a window of {size:,} bytes")
        change, self._stream_window = size - self._stream_window, size
        for stream in self._streams.values():
            stream.window += change
            if stream.window > LARGEST_WINDOW:
                raise FrameError(Code.FLOW_CONTROL_ERROR, "opened a window too far")
        self._wake_writers()

    def _window(self, frame: Frame) -> None:
        _check_length(frame, 4)
        more = int.from_bytes(frame.payload, "big") & LARGEST_WINDOW
        if more == 0 or frame.stream > self._last:
            raise FrameError(Code.PROTOCOL_ERROR, "sent a WINDOW_UPDATE that makes no sense")
        if frame.stream == 0:
            self.window += more
            size = self.window
        else:
            stream = self._streams.get(frame.stream)
            if stream is None:
                return
            stream.window += more
            size = stream.window
        if size > LARGEST_WINDOW:
            raise FrameError(Code.FLOW_CONTROL_ERROR, "opened a window too far")
        self._wake_writers()

    def _ping(self, frame: Frame) -> None:
        _check_length(frame, 8)
        if not frame.flags & Flag.ACK:
            self.send(write_frame(Kind.PING, Flag.ACK, 0, frame.payload))

    def _push(self, _: Frame) -> None:
        raise FrameError(Code.PROTOCOL_ERROR, "sent PUSH_PROMISE, which only servers may")


_TAKE: dict[int, Callable[[Connection, Frame], None]] = {
    Kind.HEADERS: Connection._begin_headers,  # noqa: SLF001 - the class's own
    Kind.CONTINUATION: Connection._continue_headers,  # noqa: SLF001
    Kind.RST_STREAM: Connection._reset,  # noqa: SLF001
    Kind.SETTINGS: Connection._settings,  # noqa: SLF001
    Kind.WINDOW_UPDATE: Connection._window,  # noqa: SLF001
    Kind.PING: Connection._ping,  # noqa: SLF001
    Kind.PUSH_PROMISE: Connection._push,  # noqa: SLF001
}


async def _serve(route: Route, stream: Stream) -> None:
    """Run the handler of a call; whatever it does, the call ends."""
    try:
        await route.handle(stream)
        stream.finish()
    except RefusalError as refusal:
        stream.finish(refusal)
    except StreamLostError:
        pass
    finally:
        stream.finish(code=UNAVAILABLE, details="the server ended the call")


def _check_length(frame: Frame, length: int) -> None:
    if len(frame.payload) != length:
        raise FrameError(Code.FRAME_SIZE_ERROR, f"sent a {_name(frame.kind)} frame of a wrong length")


def _name(kind: int) -> str:
    return Kind(kind).name if kind <= Kind.CONTINUATION else f"kind {kind}"


def _goaway(last: int, code: Code, reason: str = "") -> bytes:
    payload = last.to_bytes(4, "big") + code.to_bytes(4, "big") + reason.encode()
    return write_frame(Kind.GOAWAY, 0, 0, payload)
