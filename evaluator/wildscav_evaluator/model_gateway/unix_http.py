"""A small HTTP server on one unix socket: the protocol is h11's; the limits are ours.

A client takes time from nobody but itself: so many connections, one request at a time, and a pause after
each request that was refused. If it leaves, its request is cancelled. Nothing of a
request's header is passed on to anybody.
"""

import asyncio
import contextlib
import json
import select
import socket
from collections.abc import Callable, Coroutine
from typing import Any, NamedTuple

import h11

CONNECTIONS = 16  # at one time
LARGEST_HEADER = 16 << 10  # bytes
LARGEST_BODY = 8 << 20  # bytes
BODY_TIME = 30.0  # s to send a body, and to receive an answer
REFUSAL_PAUSE = 0.05  # s before a refusal, in which its client's other requests wait
LOOKS = 0.1  # s between two looks at whether a client has left
CHUNK = 64 << 10  # bytes
INVALID = "invalid_request_error"


class Request(NamedTuple):
    """What a client asks."""

    method: str
    target: str
    body: bytes


class Response(NamedTuple):
    """What it gets."""

    status: int
    document: dict[str, Any]


def refusal(status: int, kind: str, message: str, code: str | None = None) -> Response:
    """Return a refusal in the form of OpenAI's errors."""
    error = {"message": message, "type": kind, "param": None, "code": code}
    return Response(status, {"error": error})


class RefusedError(Exception):
    """A request cannot be read. It is answered, and its connection is closed."""

    def __init__(self, status: int, message: str) -> None:
        super().__init__(message)
        self.response = refusal(status, INVALID, message)


class UnixServer:
    """Serves the clients of one socket, which listens and does not block."""

    def __init__(
        self, listener: socket.socket, answer: Callable[[Request], Coroutine[Any, Any, Response]]
    ) -> None:
        self._listener, self._answer = listener, answer
        self._turn = asyncio.Lock()  # to be read and answered
        self._connections: set[asyncio.Task[None]] = set()

    async def run(self) -> None:
        """Serve until cancelled."""
        loop, free = asyncio.get_running_loop(), asyncio.Semaphore(CONNECTIONS)
        try:
            while True:
                await free.acquire()  # the others wait in the socket's queue
                client, _ = await loop.sock_accept(self._listener)
                task = asyncio.create_task(self._serve(client))
                self._connections.add(task)
                task.add_done_callback(self._connections.discard)
                task.add_done_callback(lambda _: free.release())
        finally:
            for task in self._connections:
                task.cancel()

    async def _serve(self, client: socket.socket) -> None:
        """Answer the requests of a connection one by one."""
        connection = _Connection(*await asyncio.open_connection(sock=client, limit=CHUNK))
        try:
            while isinstance(header := await connection.event(), h11.Request):  # which may take any time
                async with self._turn:
                    if not await self._exchange(connection, header):
                        break
        except h11.RemoteProtocolError as error:
            await asyncio.sleep(REFUSAL_PAUSE)
            with contextlib.suppress(OSError, TimeoutError, h11.LocalProtocolError):  # it has been answered
                await connection.send(refusal(error.error_status_hint, INVALID, "this is not HTTP/1.1"))
        except (OSError, TimeoutError, h11.LocalProtocolError):
            await asyncio.sleep(REFUSAL_PAUSE)
        finally:
            connection.close()

    async def _exchange(self, connection: "_Connection", header: h11.Request) -> bool:
        """Answer the request that a header begins; return whether the connection goes on."""
        try:
            response = await self._response(await connection.request(header), connection)
        except RefusedError as error:
            response, connection.goes_on = error.response, False
        if response.status >= 400:
            await asyncio.sleep(REFUSAL_PAUSE)
        await connection.send(response)
        return connection.goes_on

    async def _response(self, request: Request, connection: "_Connection") -> Response:
        """Return the answer to a request.

        Raises:
            ConnectionError: The client has left.
        """
        answering = asyncio.create_task(self._answer(request))
        try:
            while not (await asyncio.wait((answering,), timeout=LOOKS))[0]:
                if connection.is_left():
                    raise ConnectionResetError
            return answering.result()
        finally:
            answering.cancel()


class _Connection:
    """One connection of a client."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader, self._writer = reader, writer
        self._state = h11.Connection(h11.SERVER, max_incomplete_event_size=LARGEST_HEADER)
        self.goes_on = True

    async def request(self, header: h11.Request) -> Request:
        """Return the request that a header begins.

        Raises:
            RefusedError: Its body is too large, too slow, or of no known length.
        """
        names = [name for name, _ in header.headers]
        if b"transfer-encoding" in names and b"content-length" in names:
            raise RefusedError(400, "a request has Content-Length or Transfer-Encoding, not both")
        length = next((int(value) for name, value in header.headers if name == b"content-length"), 0)
        if length > LARGEST_BODY:
            raise RefusedError(413, f"a request may have {LARGEST_BODY:,} bytes")
        try:
            async with asyncio.timeout(BODY_TIME):
                body = await self._body()
        except TimeoutError:
            raise RefusedError(408, f"a request must arrive within {BODY_TIME:g} s") from None
        except h11.RemoteProtocolError:
            raise RefusedError(400, "the body of the request is not HTTP/1.1") from None
        return Request(header.method.decode("ascii"), header.target.decode("ascii", "replace"), body)

    async def _body(self) -> bytes:
        body = bytearray()
        if self._state.they_are_waiting_for_100_continue:
            go_on = h11.InformationalResponse(status_code=100, headers=[])
            self._writer.write(self._state.send(go_on) or b"")
        while isinstance(event := await self.event(), h11.Data):
            body += event.data
            if len(body) > LARGEST_BODY:
                raise RefusedError(413, f"a request may have {LARGEST_BODY:,} bytes")
        if not isinstance(event, h11.EndOfMessage):
            raise RefusedError(400, "the request ended before its body did")
        return bytes(body)

    async def event(self) -> Any:
        """Return the next event of the connection."""
        while (event := self._state.next_event()) is h11.NEED_DATA:
            self._state.receive_data(await self._reader.read(CHUNK))
        return event

    def is_left(self) -> bool:
        """Return whether the client has closed the connection, and not only its own half of it."""
        if self._writer.is_closing():
            return True
        ends = select.poll()
        ends.register(self._writer.get_extra_info("socket"), 0)
        return bool(ends.poll(0))

    def close(self) -> None:
        """Close it."""
        self._writer.close()

    async def send(self, response: Response) -> None:
        """Send an answer.

        Raises:
            OSError: The client is gone.
            TimeoutError: It does not read.
        """
        content = json.dumps(response.document, ensure_ascii=True).encode()
        headers = [("content-type", "application/json"), ("content-length", str(len(content)))]
        if not self.goes_on:
            headers.append(("connection", "close"))
        start = h11.Response(status_code=response.status, headers=headers)
        for event in (start, h11.Data(data=content), h11.EndOfMessage()):
            self._writer.write(self._state.send(event) or b"")
        async with asyncio.timeout(BODY_TIME):
            await self._writer.drain()
        if self._state.our_state is not h11.DONE or self._state.their_state is not h11.DONE:
            self.goes_on = False
        if self.goes_on:
            self._state.start_next_cycle()
