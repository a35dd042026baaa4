"""One call on a connection: its messages in both directions, and the status that ends it."""

import asyncio
import base64
import re
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any
from urllib.parse import quote

import grpc

from wildscav.wire.errors import ProtocolRefusalError, RefusalError, encode_refusal
from wildscav_server.http2.accounting import WINDOW, Account
from wildscav_server.http2.frames import MAX_PAYLOAD, Code, Flag, Kind, header_block, write_frame

PREFIX = 5  # bytes before a message: whether it is compressed, and its length
UNREAD_LIMIT = 64  # messages of a stream that wait to be read
RESPONSE = header_block([(":status", "200"), ("content-type", "application/grpc")])
DEADLINE_EXCEEDED = 4  # gRPC's status code
TIMEOUT_UNITS = {"H": 3600.0, "M": 60.0, "S": 1.0, "m": 1e-3, "u": 1e-6, "n": 1e-9}  # s


class StreamLostError(Exception):
    """The connection of a stream is gone, or its client has ended it."""


class Stream:
    """A call, as its handler sees it. If the client ends it, the handler is cancelled.

    Args:
        window: Bytes that the client accepts on the stream.
        limit: The largest message that the client may send, bytes.
        on_end: Called with the stream once its status is sent.
    """

    __slots__ = (
        "_account",
        "_begun",
        "_deadline",
        "_limit",
        "_messages",
        "_on_end",
        "_part",
        "_queued",
        "_reader",
        "_received",
        "_released",
        "_taken_by",
        "ended_by_client",
        "finished",
        "headers",
        "number",
        "refusal",
        "task",
        "window",
    )

    def __init__(
        self,
        account: Account,
        number: int,
        headers: Mapping[str, str],
        window: int,
        limit: int,
        on_end: "Callable[[Stream], None]",
    ) -> None:
        self._account, self.number, self.headers, self.window = account, number, headers, window
        self._limit, self._on_end = limit, on_end
        self.task: asyncio.Task[None] | None = None  # runs the handler
        self.refusal: RefusalError | None = None  # the client's protocol violation, if there was one
        self.ended_by_client = False  # whether the client sends nothing more
        self.finished = False  # whether the status was sent or the client is gone
        self._begun = False  # whether the response's headers were sent
        self._deadline: asyncio.TimerHandle | None = None  # ends the call
        self._part = bytearray()  # an incomplete message
        self._messages: deque[bytes] = deque()
        self._reader: asyncio.Future[None] | None = None  # done when there is something to read
        self._taken_by: Callable[[], None] | None = None  # called instead, if the handler uses ``calling``
        self._received = self._released = 0  # bytes received, and those that the client may send again
        self._queued = 0  # bytes of the messages that wait to be read

    # The interface for the handler.

    def mark_authenticated(self) -> None:
        """Mark the client as known: it is in a seat, or an organizer."""
        self._account.mark_authenticated()

    async def read(self) -> bytes:
        """Return the next message.

        Raises:
            StreamLostError: The client sends no more.
            ProtocolRefusalError: A message is too large, or compressed.
        """
        while (message := self.take()) is None:
            self._reader = asyncio.get_running_loop().create_future()
            try:
                await self._reader
            finally:
                self._reader = None
        return message

    def take(self) -> bytes | None:
        """Return the next message if there is one; raises what ``read`` does."""
        if self.refusal is not None:
            raise self.refusal
        if not self._messages:
            if self.ended_by_client:
                raise StreamLostError
            return None
        message = self._messages.popleft()
        self._queued -= PREFIX + len(message)
        self._release_received()
        return message

    @contextmanager
    def calling(self, taken_by: Callable[[], None]) -> Iterator[None]:
        """Call a function during the block, which must not raise, whenever there may be something to take."""
        self._taken_by = taken_by
        try:
            yield
        finally:
            self._taken_by = None

    def _release_received(self) -> None:
        """Let the client send as much again as was received and is not queued."""
        size = self._received - self._queued - self._released
        if size >= WINDOW // 2:
            self._released += size
            self._account.release_received(size, 0 if self.ended_by_client else self.number)

    def write_at_once(self, message: bytes) -> bool:
        """Send a message if that need not wait for the client, and return whether it was sent.

        Raises:
            StreamLostError: The client is gone.
        """
        account, size = self._account, PREFIX + len(message)
        if self.finished:
            raise StreamLostError
        if account.full or size > min(MAX_PAYLOAD, self.window, account.window):
            return False
        account.refill(size, begins=True)
        self._send(_prefixed(message))
        return True

    async def write(self, message: bytes) -> None:
        """Pass all of a message to the transport, or raise a StreamLostError if the client is gone."""
        content = _prefixed(message)
        account, at = self._account, 0
        while at < len(content):
            if self.finished:
                raise StreamLostError
            size = min(MAX_PAYLOAD, self.window, account.window, len(content) - at)
            if size <= 0 or account.full:
                await account.change()
                continue
            account.refill(size, begins=at == 0)
            self._send(content[at : at + size])
            at += size

    def _send(self, content: bytes) -> None:
        self.window -= len(content)
        self._account.window -= len(content)
        head = b"" if self._begun else write_frame(Kind.HEADERS, Flag.END_HEADERS, self.number, RESPONSE)
        self._begun = True
        self._account.send(head + write_frame(Kind.DATA, 0, self.number, content))

    def finish(self, refusal: RefusalError | None = None, code: int = 0, details: str = "") -> None:
        """End the call with a refusal, or a gRPC status code; does nothing if it has ended."""
        if self.finished:
            return
        self._end()
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
        self._account.send(frames)
        self._on_end(self)

    def _end(self) -> None:
        self.finished = True
        if self._deadline is not None:
            self._deadline.cancel()

    # The interface for the connection.

    def end_after(self, seconds: float) -> None:
        """End the call by its client's deadline, s from now."""
        self._deadline = asyncio.get_running_loop().call_later(seconds, self._expire)

    def _expire(self) -> None:
        self.finish(code=DEADLINE_EXCEEDED, details="the call's deadline has passed")
        if self.task is not None:
            self.task.cancel()

    def feed(self, content: bytes, size: int) -> bool:
        """Process data, which uses ``size`` bytes of the windows; return whether it completed a message."""
        self._received += size
        complete = False
        if self.refusal is None and not self.finished:
            self._part += content
            complete = self._queue_complete()
            self._release_received()
        self.wake()
        return complete

    @property
    def unread(self) -> int:
        """Bytes that were received, and that the client may not send again yet."""
        return self._received - self._released

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

    def half_close(self) -> None:
        """Note that the client sends nothing more."""
        self.ended_by_client = True
        self.wake()

    def wake(self) -> None:
        """Wake the handler if it waits for a message."""
        if self._taken_by is not None:
            self._taken_by()
        elif self._reader is not None and not self._reader.done():
            self._reader.set_result(None)

    def abort(self, refusal: RefusalError | None = None) -> None:
        """End the call without a status, because the client is gone, perhaps for violating the protocol."""
        self._end()
        self.refusal = self.refusal or refusal
        if self.task is not None:
            self.task.cancel()


def _prefixed(message: bytes) -> bytes:
    return b"\0" + len(message).to_bytes(4, "big") + message


def parse_timeout(text: str) -> float | None:
    """Return the seconds of a header ``grpc-timeout``, or None if it is malformed."""
    match = re.fullmatch(r"([0-9]{1,8})([HMSmun])", text)
    return int(match[1]) * TIMEOUT_UNITS[match[2]] if match else None
