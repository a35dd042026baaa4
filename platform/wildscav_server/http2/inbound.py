"""Processing of a client's data: it is split into frames, charged to the client, and passed to the calls."""

from collections.abc import Callable
from typing import Protocol

from hpack import Decoder, HPACKError

from wildscav_server.http2.allowance import (
    HEADERS_COST,
    PAYLOAD_PER_FRAME,
    READ_COST,
    Allowance,
    FloodError,
)
from wildscav_server.http2.calls import Calls
from wildscav_server.http2.flow_control import WINDOW, FlowControl
from wildscav_server.http2.frames import (
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
)
from wildscav_server.http2.stream import Stream

HEADER_LIMIT = 16_384  # bytes of the headers of a call, compressed and decompressed
OF_CONNECTION = (Kind.SETTINGS, Kind.PING, Kind.GOAWAY)  # frames that no stream may have
UNKNOWN_LIMIT = 32_768  # bytes of messages that an unknown client may send before it gets an answer


class ReadConnection(Protocol):
    """The part of a connection that the processing of its data needs."""

    known: bool  # whether the client is in a seat, or an organizer

    @property
    def allowance(self) -> Allowance:
        """The client's allowance of frames."""
        ...

    @property
    def flow(self) -> FlowControl:
        """The connection's flow control."""
        ...

    @property
    def calls(self) -> Calls:
        """The open calls."""
        ...

    @property
    def is_over(self) -> bool:
        """Whether the connection is closing or closed."""
        ...

    def send(self, content: bytes) -> None:
        """Write data to the client."""
        ...


class Inbound:
    """Processes one client's data.

    Args:
        connection: The client's connection.
    """

    def __init__(self, connection: ReadConnection) -> None:
        self._connection = connection
        self._reader, self._decoder = FrameReader(), Decoder(HEADER_LIMIT)
        self._headers: bytearray | None = None  # the headers of a call that are not complete yet
        self._headers_of = Frame(0, 0, 0, b"")  # the frame that they began with
        self.has_settings = False  # whether the client's SETTINGS were received

    def take(self, content: bytes) -> None:
        """Process data that was read.

        Raises:
            FrameError: The client has violated HTTP/2; a FloodError if it has exceeded its limits.
        """
        self._connection.allowance.spend(READ_COST)
        try:
            for frame in self._reader.feed(content):
                self._take_frame(frame)
                if self._connection.is_over:
                    return
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
            raise FrameError(Code.PROTOCOL_ERROR, f"sent {_name(kind)} on a stream")
        if kind == Kind.DATA:
            self._data(frame)
            return
        cost = HEADERS_COST if kind == Kind.HEADERS else 1.0
        self._connection.allowance.spend(cost + len(frame.payload) // PAYLOAD_PER_FRAME, _name(kind))
        take = _TAKE.get(kind)
        if take is not None:  # unknown kinds are ignored
            take(self, frame)

    # Messages.

    def _data(self, frame: Frame) -> None:
        connection = self._connection
        if not connection.calls.has_begun(frame.stream):
            raise FrameError(Code.PROTOCOL_ERROR, "sent data on a stream that it had not opened")
        size = len(frame.payload)
        connection.allowance.unanswered += size
        connection.flow.receive(size)
        if not connection.known and connection.allowance.unanswered > UNKNOWN_LIMIT:
            raise FloodError(f"sent {connection.allowance.unanswered:,} bytes without identifying itself")
        content, stream = without_padding(frame), connection.calls.of(frame.stream)
        complete = False
        if stream is None:
            connection.flow.reopen(size, 0)
        elif stream.ended_by_client:
            raise FrameError(Code.STREAM_CLOSED, "sent data on a stream that it had ended")
        else:
            complete = stream.feed(content, size)
            if stream.unread > 2 * WINDOW:
                raise FrameError(Code.FLOW_CONTROL_ERROR, "sent more than a stream's window")
            if frame.flags & Flag.END_STREAM:
                _half_close(stream)
        if not complete:
            connection.allowance.spend(1.0, "DATA")

    # Calls.

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
        calls = self._connection.calls
        stream = calls.of(number)
        if stream is not None:
            if not ends:
                raise FrameError(Code.PROTOCOL_ERROR, "sent headers twice")
            _half_close(stream)
        elif number > calls.last:
            calls.begin(number, headers, ends=ends)

    def _reset(self, frame: Frame) -> None:
        _check_length(frame, 4)
        if not self._connection.calls.has_begun(frame.stream):
            raise FrameError(Code.PROTOCOL_ERROR, "reset a stream that it had not opened")
        self._connection.calls.reset(frame.stream)

    def _push(self, _: Frame) -> None:
        raise FrameError(Code.PROTOCOL_ERROR, "sent PUSH_PROMISE, which only servers may send")

    # The connection itself.

    def _settings(self, frame: Frame) -> None:
        if frame.flags & Flag.ACK:
            return
        self.has_settings = True
        for name, value in read_settings(frame.payload):
            if name == Setting.INITIAL_WINDOW_SIZE:
                self._connection.calls.change_window(value)
            elif name == Setting.MAX_FRAME_SIZE and not LARGEST <= value < 2**24:
                raise FrameError(Code.PROTOCOL_ERROR, f"asked for frames of {value:,} bytes")
        self._connection.send(write_frame(Kind.SETTINGS, Flag.ACK, 0))

    def _window(self, frame: Frame) -> None:
        _check_length(frame, 4)
        more = int.from_bytes(frame.payload, "big") & LARGEST_WINDOW
        calls = self._connection.calls
        if more == 0 or frame.stream > calls.last:
            raise FrameError(Code.PROTOCOL_ERROR, "sent an invalid WINDOW_UPDATE")
        stream = calls.of(frame.stream)
        if stream is not None or frame.stream == 0:  # else the call has ended
            self._connection.flow.widen(more, stream)

    def _ping(self, frame: Frame) -> None:
        _check_length(frame, 8)
        if not frame.flags & Flag.ACK:
            self._connection.send(write_frame(Kind.PING, Flag.ACK, 0, frame.payload))


_TAKE: dict[int, Callable[[Inbound, Frame], None]] = {
    Kind.HEADERS: Inbound._begin_headers,  # noqa: SLF001 - the class's own
    Kind.CONTINUATION: Inbound._continue_headers,  # noqa: SLF001
    Kind.RST_STREAM: Inbound._reset,  # noqa: SLF001
    Kind.SETTINGS: Inbound._settings,  # noqa: SLF001
    Kind.WINDOW_UPDATE: Inbound._window,  # noqa: SLF001
    Kind.PING: Inbound._ping,  # noqa: SLF001
    Kind.PUSH_PROMISE: Inbound._push,  # noqa: SLF001
}


def _half_close(stream: Stream) -> None:
    stream.ended_by_client = True
    stream.wake()


def _check_length(frame: Frame, length: int) -> None:
    if len(frame.payload) != length:
        raise FrameError(Code.FRAME_SIZE_ERROR, f"sent a {_name(frame.kind)} frame of a wrong length")


def _name(kind: int) -> str:
    return Kind(kind).name if kind <= Kind.CONTINUATION else f"kind {kind}"
