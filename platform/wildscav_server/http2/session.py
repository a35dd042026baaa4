"""The HTTP/2 of one connection, without input and output: which frames begin, feed and end its calls."""

import asyncio
from collections import deque
from collections.abc import Awaitable, Callable, Mapping
from typing import NamedTuple

from hpack import Decoder, HPACKError

from wildscav.wire.errors import RefusalError
from wildscav_server.http2.accounting import (
    HEADERS_COST,
    PAYLOAD_PER_FRAME,
    READ_COST,
    WINDOW,
    Account,
    FloodError,
    grown,
)
from wildscav_server.http2.frames import (
    FIRST_WINDOW,
    LARGEST_WINDOW,
    MAX_PAYLOAD,
    Code,
    Flag,
    Frame,
    FrameError,
    FrameReader,
    Kind,
    Setting,
    kind_name,
    read_settings,
    without_padding,
    write_frame,
    write_settings,
)
from wildscav_server.http2.stream import Stream, StreamLostError, parse_timeout

STREAMS = 128  # at one time
HEADER_LIMIT = 16_384  # bytes of the headers of a call, compressed and decompressed
UNIMPLEMENTED, INTERNAL, UNAVAILABLE = 12, 13, 14  # gRPC status codes
OF_CONNECTION = (Kind.SETTINGS, Kind.PING, Kind.GOAWAY)  # frames that no stream may have
REQUIRED = {":method", ":scheme", ":path"}  # headers of a request
FORBIDDEN = {"connection", "keep-alive", "proxy-connection", "transfer-encoding", "upgrade"}  # HTTP/1's
SETTINGS = write_settings(
    {
        Setting.MAX_CONCURRENT_STREAMS: STREAMS,
        Setting.INITIAL_WINDOW_SIZE: WINDOW,
        Setting.MAX_HEADER_LIST_SIZE: HEADER_LIMIT,
    }
)


class Route(NamedTuple):
    """The handler of a method, and its limits."""

    handle: Callable[[Stream], Awaitable[None]]
    limit: int = 4096  # bytes of a message
    admit: Callable[[Stream], None] | None = None  # raises RefusalError for clients that may not call it


class Session:
    """One client's HTTP/2: processes its frames, and serves its calls."""

    def __init__(self, account: Account, routes: Mapping[str, Route]) -> None:
        self._account, self._routes = account, routes
        self._loop = asyncio.get_running_loop()
        self._reader, self._decoder = FrameReader(), Decoder(HEADER_LIMIT)
        self._headers: bytearray | None = None  # the headers of a call that are not complete yet
        self._headers_of = Frame(0, 0, 0, b"")  # the frame that they began with
        self.has_settings = False  # whether the client's SETTINGS were received
        self._streams: dict[int, Stream] = {}
        self._ended: deque[int] = deque(maxlen=STREAMS)  # recent streams that the client has ended or reset
        self._window = FIRST_WINDOW  # bytes that the client accepts on a new stream
        self._last = 0  # number of the last stream that was opened
        self._is_ending = False  # whether new calls are refused
        self.last_open = self._loop.time()  # when a call was last known to be open
        self._take_kind: dict[int, Callable[[Frame], None]] = {
            Kind.DATA: self._data,
            Kind.HEADERS: self._begin_headers,
            Kind.PRIORITY: self._priority,
            Kind.RST_STREAM: self._reset,
            Kind.SETTINGS: self._settings,
            Kind.PUSH_PROMISE: self._push,
            Kind.PING: self._ping,
            Kind.WINDOW_UPDATE: self._window_update,
            Kind.CONTINUATION: self._continue_headers,
        }

    def __len__(self) -> int:
        """Return the number of open calls."""
        return len(self._streams)

    @property
    def tasks(self) -> list[asyncio.Task[None]]:
        """The tasks that serve the calls."""
        return [stream.task for stream in self._streams.values() if stream.task is not None]

    def take(self, content: bytes) -> None:
        """Process data that was read.

        Raises:
            FrameError: The client has violated HTTP/2; a FloodError if it has exceeded its limits.
        """
        self._account.spend(READ_COST)
        try:
            for frame in self._reader.feed(content):
                self._take_frame(frame)
        except HPACKError:
            raise FrameError(Code.COMPRESSION_ERROR, "sent headers that cannot be decompressed") from None

    def _take_frame(self, frame: Frame) -> None:
        kind = frame.kind
        if self._headers is not None and (
            kind != Kind.CONTINUATION or frame.stream != self._headers_of.stream
        ):
            raise FrameError(Code.PROTOCOL_ERROR, "sent another frame in the middle of headers")
        if not self.has_settings and kind != Kind.SETTINGS:
            raise FrameError(Code.PROTOCOL_ERROR, "did not begin with SETTINGS")
        if frame.stream and kind in OF_CONNECTION:
            raise FrameError(Code.PROTOCOL_ERROR, f"sent {kind_name(kind)} on a stream")
        if kind != Kind.DATA:  # which pays by itself, unless it completes a message
            cost = HEADERS_COST if kind == Kind.HEADERS else 1.0
            self._account.spend(cost + len(frame.payload) // PAYLOAD_PER_FRAME, kind)
        take = self._take_kind.get(kind)
        if take is not None:  # unknown kinds are ignored
            take(frame)

    # Messages.

    def _data(self, frame: Frame) -> None:
        if not self._has_begun(frame.stream):
            raise FrameError(Code.PROTOCOL_ERROR, "sent data on a stream that it had not opened")
        size = len(frame.payload)
        self._account.receive(size)
        content, stream = without_padding(frame), self._streams.get(frame.stream)
        complete = False
        if stream.ended_by_client if stream else frame.stream in self._ended:
            raise FrameError(Code.STREAM_CLOSED, "sent data on a stream that it had ended")
        if stream is None:  # the server has ended it, which the client may not know yet
            self._account.release_received(size)
        else:
            complete = stream.feed(content, size)
            if stream.unread > 2 * WINDOW:
                raise FrameError(Code.FLOW_CONTROL_ERROR, "sent more than a stream's window")
            if frame.flags & Flag.END_STREAM:
                stream.half_close()
        if not complete:
            self._account.spend(1.0, Kind.DATA)

    def _has_begun(self, number: int) -> bool:
        """Return whether the client has opened or skipped the stream with a number."""
        return 0 < number <= self._last

    # How calls begin.

    def _begin_headers(self, frame: Frame) -> None:
        if frame.stream % 2 == 0:
            raise FrameError(Code.PROTOCOL_ERROR, "opened a stream with a number that is not a client's")
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
        """Begin a call, or half-close one: headers on an open stream can only be its end."""
        number, ends = self._headers_of.stream, bool(self._headers_of.flags & Flag.END_STREAM)
        compressed, self._headers = bytes(self._headers or b""), None
        # All headers are decompressed, because later ones depend on the decoder's state.
        headers = {str(name): str(value) for name, value in self._decoder.decode(compressed)}
        stream = self._streams.get(number)
        if stream.ended_by_client if stream else number in self._ended:
            raise FrameError(Code.STREAM_CLOSED, "sent headers on a stream that it had ended")
        if stream is not None:
            if not ends:
                raise FrameError(Code.PROTOCOL_ERROR, "sent headers twice")
            stream.half_close()
        elif number > self._last:
            self._last = number
            self._begin(number, headers, ends=ends)

    def _begin(self, number: int, headers: Mapping[str, str], *, ends: bool) -> None:
        """Serve a new call; ``ends`` says that the client sends nothing more on the stream."""
        if self._is_ending or len(self._streams) >= STREAMS:
            self._end_at_once(number, Code.REFUSED_STREAM)
            return
        if is_malformed(headers):
            self._end_at_once(number, Code.PROTOCOL_ERROR)
            return
        route = self._routes.get(headers[":path"])
        limit = route.limit if route else 0
        stream = Stream(self._account, number, headers, self._window, limit, self._forget)
        stream.ended_by_client = ends
        self._streams[number] = stream
        if route is None:
            stream.finish(code=UNIMPLEMENTED, details="there is no such method")
            return
        if (timeout := headers.get("grpc-timeout")) is not None:
            seconds = parse_timeout(timeout)
            if seconds is None:
                stream.finish(code=INTERNAL, details="the header grpc-timeout is malformed")
                return
            stream.end_after(seconds)
        try:
            if route.admit is not None:
                route.admit(stream)
                self._account.refund(HEADERS_COST)  # an organizer may call as often as it likes
        except RefusalError as refusal:
            stream.finish(refusal)
            return
        stream.task = self._loop.create_task(_serve(route, stream), name="stream")

    def _end_at_once(self, number: int, code: Code) -> None:
        self._account.send(write_frame(Kind.RST_STREAM, 0, number, code.to_bytes(4, "big")))

    # How calls end.

    def _reset(self, frame: Frame) -> None:
        _check_length(frame, 4)
        if not self._has_begun(frame.stream):
            raise FrameError(Code.PROTOCOL_ERROR, "reset a stream that it had not opened")
        stream = self._streams.get(frame.stream)
        if stream is not None:
            stream.ended_by_client = True
            self._forget(stream)
            stream.abort()
            self._account.wake()

    def _forget(self, stream: Stream) -> None:
        """Remove a call that has ended."""
        self.last_open = self._loop.time()
        if self._streams.pop(stream.number, None) is not None:
            if stream.ended_by_client:
                self._ended.append(stream.number)
            if stream.unread:
                self._account.release_received(stream.unread)

    def announce_end(self) -> None:
        """Tell the client that new calls are not served."""
        self._is_ending = True
        self._account.send(self.goodbye(Code.NO_ERROR))

    def goodbye(self, code: Code, reason: str = "") -> bytes:
        """Return the GOAWAY frame that ends the connection."""
        payload = self._last.to_bytes(4, "big") + code.to_bytes(4, "big") + reason.encode()
        return write_frame(Kind.GOAWAY, 0, 0, payload)

    def abort(self, refusal: RefusalError | None = None) -> None:
        """End all calls because their client is gone, or is refused for violating the protocol."""
        streams, self._streams = tuple(self._streams.values()), {}
        for stream in streams:
            stream.abort(refusal)
        self._account.wake()

    # The connection itself.

    def _settings(self, frame: Frame) -> None:
        if frame.flags & Flag.ACK:
            _check_length(frame, 0)
            return
        self.has_settings = True
        for name, value in read_settings(frame.payload):
            if name == Setting.INITIAL_WINDOW_SIZE:
                self._change_window(value)
            elif name == Setting.MAX_FRAME_SIZE and not MAX_PAYLOAD <= value < 2**24:
                raise FrameError(Code.PROTOCOL_ERROR, f"asked for frames of {value:,} bytes")
            elif name == Setting.ENABLE_PUSH and value > 1:
                raise FrameError(Code.PROTOCOL_ERROR, f"set ENABLE_PUSH to {value:,}")
        self._account.send(write_frame(Kind.SETTINGS, Flag.ACK, 0))

    def _change_window(self, size: int) -> None:
        """Change the client's initial window of streams."""
        if size > LARGEST_WINDOW:
            raise FrameError(Code.FLOW_CONTROL_ERROR, f"asked for a window of {size:,} bytes")
        change, self._window = size - self._window, size
        for stream in self._streams.values():
            stream.window = grown(stream.window, change)
        self._account.wake()

    def _window_update(self, frame: Frame) -> None:
        _check_length(frame, 4)
        more = int.from_bytes(frame.payload, "big") & LARGEST_WINDOW
        if more == 0 or frame.stream > self._last:
            raise FrameError(Code.PROTOCOL_ERROR, "sent an invalid WINDOW_UPDATE")
        stream = self._streams.get(frame.stream)
        if frame.stream == 0:
            self._account.grow_send_window(more)
        elif stream is not None:  # else the call has ended
            stream.window = grown(stream.window, more)
        self._account.wake()

    def _ping(self, frame: Frame) -> None:
        _check_length(frame, 8)
        if not frame.flags & Flag.ACK:
            self._account.send(write_frame(Kind.PING, Flag.ACK, 0, frame.payload))

    def _priority(self, frame: Frame) -> None:
        _check_length(frame, 5)

    def _push(self, _: Frame) -> None:
        raise FrameError(Code.PROTOCOL_ERROR, "sent PUSH_PROMISE, which only servers may send")


async def _serve(route: Route, stream: Stream) -> None:
    """Run the handler of a call, and end the call in any case."""
    try:
        await route.handle(stream)
        stream.finish()
    except RefusalError as refusal:
        stream.finish(refusal)
    except StreamLostError:
        pass
    finally:
        stream.finish(code=UNAVAILABLE, details="the server ended the call")


def is_malformed(headers: Mapping[str, str]) -> bool:
    """Return whether a request lacks headers, or has some that HTTP/2 forbids (RFC 9113, 8.2 and 8.3)."""
    return (
        not headers.keys() >= REQUIRED
        or bool(headers.keys() & FORBIDDEN)
        or headers.get("te", "trailers") != "trailers"
        or any(name != name.lower() for name in headers)
    )


def _check_length(frame: Frame, length: int) -> None:
    if len(frame.payload) != length:
        raise FrameError(Code.FRAME_SIZE_ERROR, f"sent a {kind_name(frame.kind)} frame of a wrong length")
