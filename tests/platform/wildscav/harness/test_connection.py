"""A connection to a model's server: what is asked and answered, and what becomes of it between requests."""

import contextlib
import socket
import ssl
import threading
from collections.abc import Callable, Iterator
from http.client import HTTPConnection, IncompleteRead
from pathlib import Path
from typing import TypeAlias

import pytest
from tests.platform.helpers.certificates import Authority, Pair

from wildscav.harness.connection import ModelConnection

WHOLE = b"HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\nhi"
NONE = b""  # the server ends the connection instead
Connect: TypeAlias = Callable[[str], ModelConnection]


class Server:
    """Answers the requests of one connection after another, and ends each after its last answer."""

    def __init__(self, listener: socket.socket, connections: tuple[list[bytes], ...]) -> None:
        self.port: int = listener.getsockname()[1]
        self.asked: list[bytes] = []  # the headers of the requests
        self.has_ended = threading.Event()  # a connection
        threading.Thread(target=self._run, args=(listener, connections), daemon=True).start()

    def _run(self, listener: socket.socket, connections: tuple[list[bytes], ...]) -> None:
        with contextlib.suppress(OSError):  # no more connections, or a client that trusts no certificate
            for answers in connections:
                with listener.accept()[0] as client:
                    for answer in answers:
                        self.asked.append(client.recv(65_536))
                        client.sendall(answer)
                self.has_ended.set()


@contextlib.contextmanager
def serving(*connections: list[bytes], host: str = "127.0.0.1", pair: Pair | None = None) -> Iterator[Server]:
    with contextlib.ExitStack() as opened:
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        listener = opened.enter_context(socket.create_server((host, 0), family=family))
        if pair is not None:
            context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
            context.load_cert_chain(*pair)
            listener = opened.enter_context(context.wrap_socket(listener, server_side=True))
        yield Server(listener, connections)


@pytest.fixture
def connect() -> Iterator[Connect]:
    with contextlib.ExitStack() as opened:
        yield lambda url: opened.enter_context(contextlib.closing(ModelConnection(url)))


def test_a_connection_is_used_again(connect: Connect) -> None:
    with serving([WHOLE, WHOLE]) as server:
        connection = connect(f"http://127.0.0.1:{server.port}")
        assert [connection.ask("/models", None, 10.0).content for _ in range(2)] == [b"hi", b"hi"]


def test_a_connection_that_the_server_has_ended_is_opened_again(connect: Connect) -> None:
    with serving([WHOLE], [WHOLE]) as server:
        connection = connect(f"http://127.0.0.1:{server.port}")
        connection.ask("/models", None, 10.0)
        assert server.has_ended.wait(10.0)
        assert connection.ask("/models", None, 10.0).status == 200


def test_a_request_is_sent_once(connect: Connect) -> None:
    with serving([WHOLE, NONE], [WHOLE]) as server:
        connection = connect(f"http://127.0.0.1:{server.port}")
        connection.ask("/models", None, 10.0)
        with pytest.raises(ConnectionError):
            connection.ask("/models", None, 10.0)
        assert len(server.asked) == 2


def test_an_answer_that_ends_early_is_none(connect: Connect) -> None:
    with serving([WHOLE[:-1]]) as server, pytest.raises(IncompleteRead):
        connect(f"http://127.0.0.1:{server.port}").ask("/models", None, 10.0)


@pytest.mark.parametrize(
    ("host", "url", "first", "name"),
    [
        ("127.0.0.1", "http://127.0.0.1/v1/", b"GET /v1/models", b"127.0.0.1"),
        ("127.0.0.1", "http://127.0.0.1/a b/ü/%20:1", b"GET /a%20b/%C3%BC/%20:1/models", b"127.0.0.1"),
        ("::1", "http://[::1]", b"GET /models", b"[::1]"),
    ],
)
def test_a_url_says_where_to_ask(
    connect: Connect, monkeypatch: pytest.MonkeyPatch, host: str, url: str, first: bytes, name: bytes
) -> None:
    with serving([WHOLE], host=host) as server:
        monkeypatch.setattr(HTTPConnection, "default_port", server.port)
        connect(url).ask("/models", None, 10.0)
        assert server.asked[0].startswith(first + b" HTTP/1.1\r\nHost: " + name + b"\r\n")


@pytest.mark.parametrize("trusted", [False, True])
def test_a_certificate_needs_an_authority_that_is_trusted(
    connect: Connect, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, trusted: bool
) -> None:
    authority = Authority(tmp_path, "authority")
    if trusted:
        monkeypatch.setenv("SSL_CERT_FILE", str(authority.path))
    with serving([WHOLE], pair=authority.sign("server")) as server:
        connection = connect(f"https://127.0.0.1:{server.port}")
        with contextlib.nullcontext() if trusted else pytest.raises(OSError, match="SSL_CERT_FILE"):
            assert connection.ask("/models", None, 10.0).status == 200
