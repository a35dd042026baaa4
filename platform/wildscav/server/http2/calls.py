"""The calls of one connection: how they begin, what serves them, and how they end."""

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from typing import NamedTuple

from wildscav.server.http2.flow_control import StreamLostError
from wildscav.server.http2.frames import (
    FIRST_WINDOW,
    LARGEST_WINDOW,
    Code,
    FrameError,
    Kind,
    write_frame,
)
from wildscav.server.http2.stream import Stream, StreamConnection
from wildscav.wire.errors import RefusalError

STREAMS = 128  # at one time
UNIMPLEMENTED, UNAVAILABLE = 12, 14  # statuses of gRPC


class Route(NamedTuple):
    """What a method is served by."""

    handle: Callable[[Stream], Awaitable[None]]
    limit: int = 4096  # bytes of a message
    admit: Callable[[Stream], None] | None = None  # raises RefusalError for whom it is not


class Calls:
    """The calls of one connection that have not ended.

    Args:
        connection: Which one.
        routes: What each method is served by.
    """

    def __init__(self, connection: StreamConnection, routes: Mapping[str, Route]) -> None:
        self._connection, self._routes = connection, routes
        self._loop = asyncio.get_running_loop()
        self._streams: dict[int, Stream] = {}
        self._window = FIRST_WINDOW  # bytes that the client takes of a new stream
        self.last = 0  # number of the last stream that was begun
        self.served = self._loop.time()  # when a call was last open, as far as that was noted

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self._streams)

    def of(self, number: int) -> Stream | None:
        """Return the call of a stream, if it has not ended."""
        return self._streams.get(number)

    def has_begun(self, number: int) -> bool:
        """Return whether the client has begun a stream with a number, or passed it over."""
        return 0 < number <= self.last

    @property
    def tasks(self) -> list[asyncio.Task[None]]:
        """What serves the calls."""
        return [stream.task for stream in self._streams.values() if stream.task is not None]

    def begin(self, number: int, headers: Mapping[str, str], *, ends: bool) -> None:
        """Serve a new call.

        Args:
            number: Of its stream.
            headers: Of the request.
            ends: Whether its client says no more.
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
        """End a call because its client has ended it."""
        stream = self._streams.get(number)
        if stream is not None:
            self.forget(stream)
            stream.break_off()
            self._connection.flow.wake()

    def forget(self, stream: Stream) -> None:
        """Let go of a call that has ended."""
        self.served = self._loop.time()
        if self._streams.pop(stream.number, None) is not None and stream.unread:
            self._connection.flow.make_room(stream.unread, 0)

    def break_off(self, refusal: RefusalError | None = None) -> None:
        """End all calls, their client being gone or put out.

        Args:
            refusal: What the client did, if it is to blame for more than to have gone.
        """
        streams, self._streams = tuple(self._streams.values()), {}
        for stream in streams:
            stream.break_off(refusal)
        self._connection.flow.wake()

    def change_window(self, size: int) -> None:
        """Hear how much the client takes of each stream.

        Args:
            size: Bytes.

        Raises:
            FrameError: That is more than a window can be.
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
