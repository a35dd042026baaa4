"""One call on a connection: its messages in both directions, and the status that ends it."""

import asyncio
import base64
from collections import deque
from collections.abc import Mapping
from typing import Any, Protocol
from urllib.parse import quote

import grpc
from hpack import Encoder, NeverIndexedHeaderTuple

from wildscav.wire.errors import ProtocolRefusalError, RefusalError, encode_refusal
from wildscav_server.http2.allowance import Allowance
from wildscav_server.http2.flow_control import WINDOW, FlowControl, StreamLostError
from wildscav_server.http2.frames import LARGEST, Code, Flag, Kind, write_frame

PREFIX = 5  # bytes before a message: whether it is compressed, and its length
UNREAD_LIMIT = 64  # messages of a stream that wait to be read


class OpenStreams(Protocol):
    """The part of a connection's calls that a stream needs."""

    def forget(self, stream: "Stream") -> None:
        """Remove a stream that has ended."""
        ...


class StreamConnection(Protocol):
    """The part of a connection that a stream needs."""

    @property
    def allowance(self) -> Allowance:
        """The client's allowance of frames."""
        ...

    @property
    def flow(self) -> FlowControl:
        """The connection's flow control."""
        ...

    @property
    def calls(self) -> OpenStreams:
        """The connection's streams."""
        ...

    def send(self, content: bytes) -> None:
        """Write data to the client."""
        ...

    def trust(self) -> None:
        """Mark the client as known."""
        ...


class Stream:
    """A call, as its handler sees it. If the client ends it, the handler is cancelled.

    Args:
        connection: Its connection.
        number: The stream's number.
        headers: The request's headers.
        window: Bytes that the client accepts on the stream.
        limit: The largest message that the client may send, bytes.
    """

    __slots__ = (
        "_begun",
        "_connection",
        "_limit",
        "_messages",
        "_part",
        "_queued",
        "_reader",
        "_received",
        "_reopened",
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
        self.refusal: RefusalError | None = None  # the client's protocol violation, if there was one
        self.ended_by_client = False  # whether the client sends nothing more
        self.finished = False  # whether the status was sent or the client is gone
        self._begun = False  # whether the response's headers were sent
        self._part = bytearray()  # an incomplete message
        self._messages: deque[bytes] = deque()
        self._reader: asyncio.Future[None] | None = None  # done when there is something to read
        self._received = self._reopened = 0  # bytes received, and those by which the window was reopened
        self._queued = 0  # bytes of the messages that wait to be read

    # The interface for the handler.

    @property
    def path(self) -> str:
        """The path of the called method."""
        return self.headers.get(":path", "")

    def trust(self) -> None:
        """Mark the client as known: it is in a seat, or an organizer."""
        self._connection.trust()

    async def read(self) -> bytes:
        """Return the next message.

        Raises:
            StreamLostError: The client sends no more.
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
        self._reopen_window()
        return message

    def _reopen_window(self) -> None:
        """Let the client send as much again as was received and is not queued."""
        size = self._received - self._queued - self._reopened
        if size >= WINDOW // 2:
            self._reopened += size
            self._connection.flow.reopen(size, 0 if self.ended_by_client else self.number)

    async def write(self, message: bytes) -> None:
        """Send a message; returns when all of it is passed to the transport.

        Raises:
            StreamLostError: The client is gone.
        """
        content = b"\0" + len(message).to_bytes(4, "big") + message
        self._connection.allowance.refill(len(content))
        flow = self._connection.flow
        if len(content) <= min(LARGEST, self.window, flow.window) and not flow.full:
            self._send(content)
            return
        at = 0
        while at < len(content):
            await flow.wait_for_window(self)
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
        """Return the frame of the response's headers if it was not sent yet, else nothing."""
        if self._begun:
            return b""
        self._begun = True
        return write_frame(Kind.HEADERS, Flag.END_HEADERS, self.number, RESPONSE)

    def finish(self, refusal: RefusalError | None = None, code: int = 0, details: str = "") -> None:
        """End the call; does nothing if it has ended.

        Args:
            refusal: Why the call is refused; None if it is not.
            code: The gRPC status code, if there is no refusal.
            details: The details of that status.
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

    # The interface for the connection.

    def feed(self, content: bytes, size: int) -> bool:
        """Process data from the client, and return whether it completed a message.

        Args:
            content: The data.
            size: Bytes that it uses of the windows, padding included.
        """
        self._received += size
        complete = False
        if self.refusal is None and not self.finished:
            self._part += content
            complete = self._queue_complete()
            self._reopen_window()
        self.wake()
        return complete

    @property
    def unread(self) -> int:
        """Bytes that were received and by which the window was not reopened yet."""
        return self._received - self._reopened

    def _queue_complete(self) -> bool:
        """Queue the messages that are complete, and return whether there were any."""
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
        if len(self._messages) > UNREAD_LIMIT:
            self.refusal = ProtocolRefusalError("FLOOD", f"sent {UNREAD_LIMIT} messages ahead")
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
        """Wake the handler if it waits for a message."""
        if self._reader is not None and not self._reader.done():
            self._reader.set_result(None)

    def abort(self, refusal: RefusalError | None = None) -> None:
        """End the call without a status, because the client is gone.

        Args:
            refusal: What the client did, if it has violated the protocol.
        """
        self.finished = True
        self.refusal = self.refusal or refusal
        if self.task is not None:
            self.task.cancel()


def header_block(headers: "list[tuple[str, str]]") -> bytes:
    """Return headers encoded by HPACK without its dynamic table, so that the encoding needs no state."""
    return Encoder().encode([NeverIndexedHeaderTuple(*header) for header in headers], huffman=False)


RESPONSE = header_block([(":status", "200"), ("content-type", "application/grpc")])
