"""A server with a few calls, and clients for it that speak HTTP/2 frame by frame."""

import asyncio
import socket
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from contextlib import contextmanager
from typing import NamedTuple

import grpc
from tests.platform.helpers import raw_http2
from tests.platform.helpers.raw_http2 import PING, frame

from wildscav.wire.errors import RefusalError
from wildscav_server.endpoints.routes import Health
from wildscav_server.http2.connection import Listener
from wildscav_server.http2.session import Route
from wildscav_server.http2.stream import Stream, StreamLostError

ECHO = "/wildscav.match.v1.Match/Play"  # which raw_http2 calls
CHECK = "/grpc.health.v1.Health/Check"
HANG, LARGE, REFUSE = "/test.Peer/Hang", "/test.Peer/Large", "/test.Peer/Refuse"
SIZE = 300_000  # bytes of the large message
MARK = b"the mark"  # of the ping that ends what a raw client sends


async def echo(stream: Stream) -> None:
    while True:
        try:
            message = await stream.read()
        except StreamLostError:
            return
        await stream.write(message)


async def hang(_: Stream) -> None:
    await asyncio.sleep(60)


async def send_large(stream: Stream) -> None:
    await stream.read()
    await stream.write(bytes(SIZE))


async def refuse(_: Stream) -> None:
    raise RefusalError(grpc.StatusCode.NOT_FOUND, "SOME_REASON", "nothing to see: 100 % of it, naïve")


class Server:
    """Serves in a thread."""

    def __init__(self) -> None:
        self._loop = asyncio.new_event_loop()
        self._at = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self._at.getsockname()[1]}"
        self._thread = threading.Thread(target=self._loop.run_forever)
        self._thread.start()
        self.call(self._start)

    def _start(self) -> None:
        health = Health()
        health.serving = True
        known = Stream.mark_authenticated
        routes = {
            ECHO: Route(echo, 1 << 20, known),
            HANG: Route(hang, 4096, known),
            LARGE: Route(send_large, 4096, known),
            REFUSE: Route(refuse),
            **health.routes(),
        }
        self.listener = Listener([self._at], routes, connections=100)
        self.listener.start()

    def call(self, function: Callable[[], object]) -> object:
        """Call a function in the server's thread."""
        done: Future[object] = Future()
        self._loop.call_soon_threadsafe(lambda: done.set_result(function()))
        return done.result(10)

    def wait_for_calls_to_end(self) -> None:
        """Wait until no connection has a call."""
        until = time.monotonic() + 10
        while self.call(lambda: sum(len(one.session) for one in self.listener._open)):
            assert time.monotonic() < until, "calls of clients that are gone stay open"
            time.sleep(0.01)

    def stop(self) -> None:
        asyncio.run_coroutine_threadsafe(self.listener.stop(1.0), self._loop).result(10)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()


class Answer(NamedTuple):
    """A frame from the server."""

    kind: int
    flags: int
    stream: int
    payload: bytes


def answers(talk: socket.socket) -> Iterator[Answer]:
    """The server's frames, until it has answered the ping at the end or closed the connection."""
    with talk.makefile("rb") as stream:
        while head := stream.read(9):
            payload = stream.read(int.from_bytes(head[:3], "big"))
            answer = Answer(head[3], head[4], int.from_bytes(head[5:9], "big"), payload)
            yield answer
            if (answer.kind, answer.flags, answer.payload) == (PING, 1, MARK):
                return


@contextmanager
def greeted(address: str) -> Iterator[socket.socket]:
    """A raw connection that has sent its preface and its SETTINGS."""
    with raw_http2.greet(address) as talk:
        talk.settimeout(20)
        yield talk


def converse(address: str, frames: bytes) -> Sequence[Answer]:
    """Send frames and a ping; return all that the server sends until it has processed them."""
    with greeted(address) as talk:
        talk.sendall(frames + frame(PING, 0, 0, MARK))
        return list(answers(talk))
