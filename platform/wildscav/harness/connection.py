"""A connection to a model's server, at a URL or at the unix socket of a gateway, by the standard library.

OpenAI's own client would take a second and 36 MB to load, in every seat.
"""

import contextlib
import selectors
import socket
import ssl
import time
from http.client import HTTPConnection, HTTPSConnection, IncompleteRead
from math import isinf
from typing import NamedTuple
from urllib.parse import quote, urlsplit

from wildscav.harness.answers import LARGEST_ANSWER

SOCKET = "unix:"  # begins the address of a gateway
CONNECT_TIME = 10.0  # s
PIECE = 1 << 16  # bytes
IN_PATHS = "/%:@!$&'()*+,;="  # stay as they are; letters and digits do in any case


class Response(NamedTuple):
    """What a server answers."""

    status: int
    content: bytes
    retry_after: str  # the header of this name


class ModelConnection:
    """A connection that stays open from one request to the next.

    Args:
        url: Of the server, up to the version; or unix:/path of a gateway.
        key: Of the server, or "".

    Raises:
        ValueError: The URL is not valid.
        HTTPException: Likewise.
    """

    def __init__(self, url: str, key: str = "") -> None:
        parts = urlsplit(url)
        if url.startswith(SOCKET):
            self._http: HTTPConnection = _UnixConnection(url.removeprefix(SOCKET))
            self._path = "/v1"
        else:
            if not parts.hostname:
                raise ValueError("it has no host")
            kind = HTTPSConnection if parts.scheme == "https" else HTTPConnection
            # Without a port, it would look for one in an IPv6 address.
            self._http = kind(parts.hostname, parts.port or kind.default_port)
            self._path = quote(parts.path.rstrip("/"), IN_PATHS)
        self._socket: socket.socket | None = None
        self._headers = {"Content-Type": "application/json", "User-Agent": "wildscav"}
        if key:
            self._headers["Authorization"] = f"Bearer {key}"

    def ask(self, path: str, body: bytes | None, seconds: float) -> Response:
        """Return the answer to a request, which is posted if it has a body.

        Raises:
            OSError: The server cannot be reached, or leaves; or its answer is too large.
            TimeoutError: The answer is not complete within some seconds.
            HTTPException: The server does not speak HTTP.
        """
        end = time.monotonic() + seconds
        try:
            self._open(seconds)
            self._http.request("GET" if body is None else "POST", self._path + path, body, self._headers)
            with self._http.getresponse() as response:
                content = bytearray()
                while piece := response.read1(PIECE):
                    content += piece
                    if len(content) > LARGEST_ANSWER:
                        raise OSError(f"its answer has more than {LARGEST_ANSWER:,} bytes")
                    if time.monotonic() > end:
                        raise TimeoutError
                if response.length:
                    raise IncompleteRead(bytes(content), response.length)
                return Response(response.status, bytes(content), response.headers.get("Retry-After", ""))
        except BaseException:
            self.close()
            raise

    def _open(self, seconds: float) -> None:
        """Connect, unless there is a connection that the server has not ended."""
        opened = self._http.sock
        if opened is not None and _is_readable(opened):
            self.close()
        limit = None if isinf(seconds) else seconds
        if self._http.sock is None:
            self._http.timeout = limit and min(CONNECT_TIME, limit)
            try:
                self._http.connect()
            except ssl.SSLCertVerificationError as error:
                hint = "the variable SSL_CERT_FILE may name a file of authorities"
                raise OSError(f"{error.verify_message}; {hint}") from None
        # http.client forgets its socket before it has read an answer after which it ends.
        self._socket = self._http.sock
        self._socket.settimeout(limit)

    def cut(self) -> None:
        """Wake the thread that waits for an answer, which then fails."""
        if self._socket is not None:
            with contextlib.suppress(OSError):
                self._socket.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """Close it; the next request opens it again."""
        self._http.close()


def _is_readable(opened: socket.socket) -> bool:
    """Return whether the server has ended a connection, or says something that nobody asked for."""
    with selectors.DefaultSelector() as selector:
        selector.register(opened, selectors.EVENT_READ)
        return bool(selector.select(0.0))


class _UnixConnection(HTTPConnection):
    """A connection to a unix socket."""

    def __init__(self, path: str) -> None:
        super().__init__("model")
        self._path = path

    def connect(self) -> None:
        """Connect."""
        self.sock = socket.socket(socket.AF_UNIX)
        self.sock.settimeout(self.timeout)
        self.sock.connect(self._path)
