"""One call on a connection: messages in, messages out, and the status that ends it."""

import asyncio
import base64
from collections import deque
from collections.abc import Mapping
from typing import Any, Protocol
from urllib.parse import quote

import grpc
from hpack import Encoder, NeverIndexedHeaderTuple

from wildscav.server.http2.allowance import Allowance
from wildscav.server.http2.flow_control import WINDOW, FlowControl, StreamLostError
from wildscav.server.http2.frames import LARGEST, Code, Flag, Kind, write_frame
from wildscav.wire.errors import ProtocolRefusalError, RefusalError, encode_refusal

PREFIX = 5  # bytes before a message: whether it is compressed, and its length
WAITING = 64  # messages of a stream that nobody has read


class OpenStreams(Protocol):
    """What a stream needs of the list of a connection's streams."""

    def forget(self, stream: "Stream") -> None:
        """Take a stream that has ended off the list."""
        ...


class StreamConnection(Protocol):
    """What a stream needs of the connection that it is on."""

    @property
    def allowance(self) -> Allowance:
        """What the client may still cost."""
        ...

    @property
    def flow(self) -> FlowControl:
        """How much may be sent, either way."""
        ...

    @property
    def calls(self) -> OpenStreams:
        """The connection's streams."""
        ...

    def send(self, content: bytes) -> None:
        """Write something to the client."""
        ...

    def trust(self) -> None:
        """Count the client as known."""
        ...


class Stream:
    """A call, as its handler sees it. Its client can end it at any time: the handler is cancelled then.

    Args:
        connection: That it is on.
        number: Of the stream.
        headers: Of the request.
        window: Bytes that the client takes of it.
        limit: Bytes of a message.
    """

    __slots__ = (
        "_arrived",
        "_begun",
        "_connection",
        "_given",
        "_limit",
        "_messages",
        "_part",
        "_queued",
        "_reader",
        "ended_by_client",
        "finished",
        "headers",
        "number",
        "refusal",
        "task",
        "window",
    )

    def __init__(
        self, connection: StreamConnection, number: int, headers: Mapping[str, str], window: int, limit: int
    ) -> None:
        self._connection, self.number, self.headers, self.window = connection, number, headers, window
        self.task: asyncio.Task[None] | None = None  # runs the handler
        self._limit = limit
        self.refusal: RefusalError | None = None  # why the handler was cancelled, if by what the client did
        self.ended_by_client = False
        self.finished = False  # whether the status was sent, or nobody is there to hear it
        self._begun = False  # whether the response's headers were sent
        self._part = bytearray()  # of a message that is not all there
        self._messages: deque[bytes] = deque()
        self._reader: asyncio.Future[None] | None = None  # done when there is something to be read
        self._arrived = self._given = 0  # bytes that arrived, and those that room was made for again
        self._queued = 0  # bytes of the messages that wait to be read

    # What the handler calls.

    @property
    def path(self) -> str:
        """The method that is called."""
        return self.headers.get(":path", "")

    def trust(self) -> None:
        """Say that the client is known: it is in a seat, or an organizer."""
        self._connection.trust()

    async def read(self) -> bytes:
        """Return the next message.

        Raises:
            StreamLostError: The client says no more.
            ProtocolRefusalError: A message is too large, or compressed.
        """
        while not self._messages or self.refusal is not None:
            if self.refusal is not None:
                raise self.refusal
            if self.ended_by_client:
                raise StreamLostError
            self._reader = asyncio.get_running_loop().create_future()
            try:
                await self._reader
            finally:
                self._reader = None
        message = self._messages.popleft()
        self._queued -= PREFIX + len(message)
        self._make_room()
        return message

    def _make_room(self) -> None:
        """Let the client send as much again as was taken in and is not waiting to be read."""
        room = self._arrived - self._queued - self._given
        if room >= WINDOW // 2:
            self._given += room
            self._connection.flow.make_room(room, 0 if self.ended_by_client else self.number)

    async def write(self, message: bytes) -> None:
        """Send a message; returns when all of it is on its way.

        Raises:
            StreamLostError: Nobody is there any more.
        """
        content = b"\0" + len(message).to_bytes(4, "big") + message
        self._connection.allowance.earn(len(content))
        flow = self._connection.flow
        if len(content) <= min(LARGEST, self.window, flow.window) and not flow.full:
            self._send(content)
            return
        at = 0
        while at < len(content):
            await flow.room_for(self)
            size = min(LARGEST, self.window, flow.window)
            self._send(content[at : at + size])
            at += size

    def _send(self, content: bytes) -> None:
        if self.finished:
            raise StreamLostError
        self.window -= len(content)
        self._connection.flow.window -= len(content)
        self._connection.send(self._head() + write_frame(Kind.DATA, 0, self.number, content))

    def _head(self) -> bytes:
        """Return the frame of the response's headers, if it was not sent yet."""
        if self._begun:
            return b""
        self._begun = True
        return write_frame(Kind.HEADERS, Flag.END_HEADERS, self.number, RESPONSE)

    def finish(self, refusal: RefusalError | None = None, code: int = 0, details: str = "") -> None:
        """End the call; does nothing if it has ended.

        Args:
            refusal: Why it is not served; none if it was.
            code: The status of gRPC, if there is no refusal.
            details: Of that status.
        """
        if self.finished:
            return
        self.finished = True
        trailers = [("grpc-status", str(code)), ("grpc-message", quote(details, safe=" "))]
        if refusal is not None:
            status: Any = encode_refusal(refusal)
            trailers = [
                ("grpc-status", str(status.code.value[0])),
                ("grpc-message", quote(status.details, safe=" ")),
            ]
            trailers += [(name, base64.b64encode(value).decode()) for name, value in status.trailing_metadata]
        payload = (b"" if self._begun else RESPONSE) + header_block(trailers)
        frames = write_frame(Kind.HEADERS, Flag.END_HEADERS | Flag.END_STREAM, self.number, payload)
        if not self.ended_by_client:
            frames += write_frame(Kind.RST_STREAM, 0, self.number, Code.NO_ERROR.to_bytes(4, "big"))
        self._connection.send(frames)
        self._connection.calls.forget(self)

    # What the connection calls.

    def feed(self, content: bytes, taken: int) -> bool:
        """Take a piece of what the client sends; return whether it completed a message.

        Args:
            content: The piece.
            taken: Bytes that it takes of the windows, padding included.
        """
        self._arrived += taken
        complete = False
        if self.refusal is None and not self.finished:
            self._part += content
            complete = self._complete()
            self._make_room()
        self.wake()
        return complete

    @property
    def unread(self) -> int:
        """Bytes that have arrived and for which no room was made again."""
        return self._arrived - self._given

    def _complete(self) -> bool:
        """Take the messages out of what has arrived that are all there."""
        part, complete = self._part, False
        while len(part) >= PREFIX:
            length = int.from_bytes(part[1:PREFIX], "big")
            if part[0] or length > self._limit:
                self._refuse_message(length, compressed=bool(part[0]))
                break
            if len(part) < PREFIX + length:
                break
            self._messages.append(bytes(part[PREFIX : PREFIX + length]))
            self._queued += PREFIX + length
            del part[: PREFIX + length]
            complete = True
        if len(self._messages) > WAITING:
            self.refusal = ProtocolRefusalError("FLOOD", f"sent {WAITING} messages ahead")
        if self.refusal is not None:
            part.clear()
        return complete

    def _refuse_message(self, length: int, *, compressed: bool) -> None:
        if compressed:
            self.refusal = ProtocolRefusalError("PROTOCOL_ERROR", "sent a compressed message")
            return
        self.refusal = ProtocolRefusalError(
            "MESSAGE_TOO_LARGE",
            f"sent a message of {length:,} bytes; {self._limit:,} are allowed",
            grpc.StatusCode.RESOURCE_EXHAUSTED,
        )

    def wake(self) -> None:
        """Have the handler look again."""
        if self._reader is not None and not self._reader.done():
            self._reader.set_result(None)

    def break_off(self, refusal: RefusalError | None = None) -> None:
        """End the call from the client's side: nobody hears what it is told now.

        Args:
            refusal: What the client did, if it is to blame for more than to have gone.
        """
        self.finished = True
        self.refusal = self.refusal or refusal
        if self.task is not None:
            self.task.cancel()


def header_block(headers: "list[tuple[str, str]]") -> bytes:
    """Return headers as HPACK writes them, without any use of its table: so they need no state."""
    return Encoder().encode([NeverIndexedHeaderTuple(*header) for header in headers], huffman=False)


RESPONSE = header_block([(":status", "200"), ("content-type", "application/grpc")])
