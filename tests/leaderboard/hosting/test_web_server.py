"""Clients that open connections and send little or nothing: they are ended, and others are served."""

import asyncio
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Receive, Scope, Send
from tests.leaderboard.seasons_made import make_season
from tests.leaderboard.spectating.served import running

from wildscav_leaderboard.hosting import web_server
from wildscav_leaderboard.hosting.web_server import configured
from wildscav_leaderboard.spectating.streams import ENDLESS

LARGE = 8 << 20  # bytes
WHOLE = b"GET / HTTP/1.1\r\nHost: a\r\n\r\n"


async def reads(scope: Scope, receive: Receive, send: Send) -> None:
    """Read a request to its end, and answer it."""
    while (message := await receive()).get("more_body"):
        pass
    if message["type"] == "http.request":
        await PlainTextResponse("ok")(scope, receive, send)


class Endless:
    """An application whose answers end when their connections do."""

    def __init__(self) -> None:
        self.ended = threading.Event()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        scope[ENDLESS] = True
        await send({"type": "http.response.start", "status": 200, "headers": []})
        sending = asyncio.create_task(
            send({"type": "http.response.body", "body": bytes(20 << 20), "more_body": True})
        )
        while (await receive())["type"] != "http.disconnect":
            pass
        await sending
        self.ended.set()


@contextmanager
def listening(folder: Path, more: str = "", app: ASGIApp = reads) -> Iterator[tuple[str, int]]:
    """Serve an application as a season is served, and give its address."""
    config = configured(make_season(folder, more), app)
    config.lifespan = "off"
    with running(config) as there:
        yield there


def answers(connection: socket.socket) -> bool:
    """Return whether a request on a connection is answered; not if the connection was ended."""
    with suppress(ConnectionError):
        connection.sendall(WHOLE)
        return connection.recv(12) == b"HTTP/1.1 200"
    return False


@pytest.mark.parametrize(
    "sent", [b"", b"GET / HTTP/1.1\r\nHost:", b"POST / HTTP/1.1\r\nHost: a\r\nContent-Length: 9\r\n\r\nhalf"]
)
def test_a_request_that_never_ends_is_ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, sent: bytes
) -> None:
    monkeypatch.setattr(web_server, "INTERVAL", 0.05)
    with listening(tmp_path / "season") as there, socket.create_connection(there, timeout=30.0) as connection:
        connection.sendall(sent)
        with suppress(ConnectionResetError):
            assert connection.recv(1) == b""


def test_who_does_not_read_an_answer_is_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(web_server, "INTERVAL", 0.05)
    app = Endless()
    with listening(tmp_path / "season", app=app) as there, socket.create_connection(there) as connection:
        connection.sendall(WHOLE)
        assert app.ended.wait(30.0)


def test_who_reads_an_answer_slowly_gets_all_of_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(web_server, "INTERVAL", 0.5)
    monkeypatch.setattr(web_server, "LEAST", 1000)

    async def app(scope: Scope, receive: Receive, send: Send) -> None:
        await PlainTextResponse(bytes(LARGE))(scope, receive, send)

    with listening(tmp_path / "season", app=app) as there, socket.socket() as connection:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 16)
        connection.connect(there)
        connection.sendall(WHOLE)
        began, count = time.monotonic(), 0
        while count < LARGE:
            read = len(connection.recv(1 << 15))
            assert read, f"it was ended after {count} bytes"
            count += read
            time.sleep(0.01)
        assert time.monotonic() - began > 3 * web_server.INTERVAL


def test_a_stream_ends_when_the_server_stops(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(web_server, "GRACE", 600)
    app = Endless()
    with listening(tmp_path / "season", app=app) as there:
        connection = socket.create_connection(there)
        connection.sendall(WHOLE)
        assert connection.recv(1)
    assert app.ended.is_set()
    connection.close()


@pytest.mark.parametrize("name", ["IN_ALL", "OF_ONE"])
def test_one_client_cannot_use_up_all_connections(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.setattr(web_server, name, 3)
    with listening(tmp_path / "season") as there:
        opened = [socket.create_connection(there, timeout=30.0) for _ in range(5)]
        assert [answers(one) for one in opened] == [True, True, True, False, False]
        for one in opened:
            one.close()


def test_a_proxy_passes_on_the_requests_of_many(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(web_server, "OF_ONE", 3)
    with listening(tmp_path / "season", '[web]\nproxies = ["127.0.0.0/8"]\n') as there:
        opened = [socket.create_connection(there, timeout=30.0) for _ in range(5)]
        assert all(answers(one) for one in opened)
        for one in opened:
            one.close()
