"""What a client sends: it is taken apart here, frame by frame, counted, and handed to the calls."""

from collections.abc import Callable
from typing import Protocol

from hpack import Decoder, HPACKError

from wildscav.server.http2.allowance import HEADERS_COST, HEAVY, READ_COST, Allowance, FloodError
from wildscav.server.http2.calls import Calls
from wildscav.server.http2.flow_control import WINDOW, FlowControl
from wildscav.server.http2.frames import (
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
from wildscav.server.http2.stream import Stream

HEADER_LIMIT = 16_384  # bytes of the headers of a call, packed and unpacked
UNKNOWN_LIMIT = 32_768  # bytes of messages that a client may send before it is known


class ReadConnection(Protocol):
    """What is needed of a connection to take in what its client sends."""

    known: bool  # whether the client is in a seat, or an organizer

    @property
    def allowance(self) -> Allowance:
        """What the client may still cost."""
        ...

    @property
    def flow(self) -> FlowControl:
        """How much may be sent, either way."""
        ...

    @property
    def calls(self) -> Calls:
        """The calls that have not ended."""
        ...

    @property
    def is_over(self) -> bool:
        """Whether nothing that comes matters any more."""
        ...

    def send(self, content: bytes) -> None:
        """Write something to the client."""
        ...


class Inbound:
    """Takes what one client sends.

    Args:
        connection: The client's.
    """

    def __init__(self, connection: ReadConnection) -> None:
        self._connection = connection
        self._reader, self._decoder = FrameReader(), Decoder(HEADER_LIMIT)
        self._headers: bytearray | None = None  # of a call that is not all there
        self._headers_of = Frame(0, 0, 0, b"")  # the frame that they began with
        self._said = 0  # bytes of messages
        self.greeted = False  # whether the client's SETTINGS came

    def take(self, content: bytes) -> None:
        """Take what was read.

        Raises:
            FrameError: The client does not speak HTTP/2 as it should; a FloodError: it sends too much.
        """
        self._connection.allowance.spend(READ_COST)
        try:
            for frame in self._reader.feed(content):
                self._take_frame(frame)
                if self._connection.is_over:
                    return
        except HPACKError:
            raise FrameError(Code.COMPRESSION_ERROR, "sent headers that cannot be unpacked") from None

    def _take_frame(self, frame: Frame) -> None:
        kind = frame.kind
        if self._headers is not None and (
            kind != Kind.CONTINUATION or frame.stream != self._headers_of.stream
        ):
            raise FrameError(Code.PROTOCOL_ERROR, "sent something else in the middle of headers")
        if not self.greeted and kind != Kind.SETTINGS:
            raise FrameError(Code.PROTOCOL_ERROR, "did not begin with SETTINGS")
        if kind == Kind.DATA:
            self._data(frame)
            return
        cost = HEADERS_COST if kind == Kind.HEADERS else 1.0
        self._connection.allowance.spend(cost + len(frame.payload) // HEAVY, _name(kind))
        take = _TAKE.get(kind)
        if take is not None:  # what is not known is ignored
            take(self, frame)

    # Messages.

    def _data(self, frame: Frame) -> None:
        connection = self._connection
        if not connection.calls.has_begun(frame.stream):
            raise FrameError(Code.PROTOCOL_ERROR, "sent data of no call")
        taken = len(frame.payload)
        self._said += taken
        connection.flow.arrive(taken)
        if not connection.known and self._said > UNKNOWN_LIMIT:
            raise FloodError(f"sent {self._said:,} bytes without saying who it is")
        content, stream = without_padding(frame), connection.calls.of(frame.stream)
        complete = False
        if stream is None:
            connection.flow.make_room(taken, 0)
        else:
            complete = stream.feed(content, taken)
            if stream.unread > 2 * WINDOW:
                raise FrameError(Code.FLOW_CONTROL_ERROR, "sent more of a call than there was room for")
            if frame.flags & Flag.END_STREAM:
                _half_close(stream)
        if not complete:
            connection.allowance.spend(1.0, "DATA")

    # Calls.

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
            raise FrameError(Code.PROTOCOL_ERROR, "ended a call that it had not begun")
        self._connection.calls.reset(frame.stream)

    def _push(self, _: Frame) -> None:
        raise FrameError(Code.PROTOCOL_ERROR, "sent PUSH_PROMISE, which only servers may")

    # The connection itself.

    def _settings(self, frame: Frame) -> None:
        if frame.flags & Flag.ACK:
            return
        self.greeted = True
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
            raise FrameError(Code.PROTOCOL_ERROR, "sent a WINDOW_UPDATE that makes no sense")
        stream = calls.of(frame.stream)
        if stream is not None or frame.stream == 0:  # else it is of a call that has ended
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
