"""The calls of one connection: how they begin, how they are served, and how they end."""

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from typing import NamedTuple

from wildscav.wire.errors import RefusalError
from wildscav_server.http2.flow_control import StreamLostError
from wildscav_server.http2.frames import (
    FIRST_WINDOW,
    LARGEST_WINDOW,
    Code,
    FrameError,
    Kind,
    write_frame,
)
from wildscav_server.http2.stream import Stream, StreamConnection

STREAMS = 128  # at one time
UNIMPLEMENTED, UNAVAILABLE = 12, 14  # gRPC status codes


class Route(NamedTuple):
    """The handler of a method, and its limits."""

    handle: Callable[[Stream], Awaitable[None]]
    limit: int = 4096  # bytes of a message
    admit: Callable[[Stream], None] | None = (
        None  # raises RefusalError for clients that may not call the method
    )


class Calls:
    """The open calls of one connection.

    Args:
        connection: The connection.
        routes: The route of each method.
    """

    def __init__(self, connection: StreamConnection, routes: Mapping[str, Route]) -> None:
        self._connection, self._routes = connection, routes
        self._loop = asyncio.get_running_loop()
        self._streams: dict[int, Stream] = {}
        self._window = FIRST_WINDOW  # bytes that the client accepts on a new stream
        self.last = 0  # number of the last stream that was opened
        self.last_open = self._loop.time()  # when a call was last known to be open

    def __len__(self) -> int:
        """Return the number of open calls."""
        return len(self._streams)

    def of(self, number: int) -> Stream | None:
        """Return the open call with a stream's number, or None."""
        return self._streams.get(number)

    def has_begun(self, number: int) -> bool:
        """Return whether the client has opened or skipped the stream with a number."""
        return 0 < number <= self.last

    @property
    def tasks(self) -> list[asyncio.Task[None]]:
        """The tasks that serve the calls."""
        return [stream.task for stream in self._streams.values() if stream.task is not None]

    def begin(self, number: int, headers: Mapping[str, str], *, ends: bool) -> None:
        """Serve a new call.

        Args:
            number: The stream's number.
            headers: The request's headers.
            ends: Whether the client sends nothing more on the stream.
        """
        self.last = number
        if len(self._streams) >= STREAMS:
            refused = Code.REFUSED_STREAM.to_bytes(4, "big")
            self._connection.send(write_frame(Kind.RST_STREAM, 0, number, refused))
            return
        route = self._routes.get(headers.get(":path", ""))
        stream = Stream(self._connection, number, headers, self._window, route.limit if route else 0)
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

    def reset(self, number: int) -> None:
        """End a call because its client has reset the stream."""
        stream = self._streams.get(number)
        if stream is not None:
            self.forget(stream)
            stream.abort()
            self._connection.flow.wake()

    def forget(self, stream: Stream) -> None:
        """Remove a call that has ended."""
        self.last_open = self._loop.time()
        if self._streams.pop(stream.number, None) is not None and stream.unread:
            self._connection.flow.reopen(stream.unread, 0)

    def abort(self, refusal: RefusalError | None = None) -> None:
        """End all calls because their client is gone or was refused.

        Args:
            refusal: What the client did, if it has violated the protocol.
        """
        streams, self._streams = tuple(self._streams.values()), {}
        for stream in streams:
            stream.abort(refusal)
        self._connection.flow.wake()

    def change_window(self, size: int) -> None:
        """Change the client's initial window of streams.

        Args:
            size: The window, bytes.

        Raises:
            FrameError: It is larger than allowed.
        """
        if size > LARGEST_WINDOW:
            raise FrameError(Code.FLOW_CONTROL_ERROR, f"asked for a window of {size:,} bytes")
        change, self._window = size - self._window, size
        for stream in self._streams.values():
            stream.window += change
            if stream.window > LARGEST_WINDOW:
                raise FrameError(Code.FLOW_CONTROL_ERROR, "opened a window too far")
        self._connection.flow.wake()


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
