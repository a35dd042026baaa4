"""Receivers of webhooks: real HTTP servers on loopback addresses."""

import ssl
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from socketserver import TCPServer
from typing import Any

from tests.platform.helpers.certificates import Pair


@dataclass
class Receiver:
    """A receiver and what it got. ``statuses`` are its next answers; after them, it answers with 204."""

    port: int = 0
    statuses: list[int] = field(default_factory=list)
    got: list[tuple[dict[str, str], str]] = field(default_factory=list)  # headers and bodies
    arrived: threading.Semaphore = field(default_factory=lambda: threading.Semaphore(0))

    def url(self, host: str = "127.0.0.1", scheme: str = "http") -> str:
        """Return its address."""
        return f"{scheme}://{host}:{self.port}/hook"


@contextmanager
def receiver(
    *statuses: int, host: str = "127.0.0.1", pair: Pair | None = None, **headers: str
) -> Iterator[Receiver]:
    """Run a receiver that answers with these statuses and headers."""
    found = Receiver(statuses=list(statuses))

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["content-length"])).decode()
            found.got.append(({name.lower(): value for name, value in self.headers.items()}, body))
            self.send_response(found.statuses.pop(0) if found.statuses else 204)
            for name, value in headers.items():
                self.send_header(name, value)
            self.end_headers()
            found.arrived.release()

        def log_message(self, *_: Any) -> None:
            pass

    with running(ThreadingHTTPServer((host, 0), Handler), pair) as found.port:
        yield found


@contextmanager
def running(server: TCPServer, pair: Pair | None = None) -> Iterator[int]:
    """Run a server, with TLS if there is a certificate; give its port."""
    if pair is not None:
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(pair.cert, pair.key)
        server.socket = context.wrap_socket(server.socket, server_side=True)
    thread = threading.Thread(target=server.serve_forever, args=(0.05,))
    thread.start()
    try:
        yield server.server_address[1]
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
