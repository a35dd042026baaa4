"""Asks the gateway of a match at its unix socket, with nothing but the standard library."""

import json
import socket
import time
from collections.abc import Mapping
from contextlib import closing
from http.client import HTTPConnection, HTTPException, HTTPResponse
from math import isinf
from typing import Any

from wildscav.harness.answers import LARGEST_ANSWER, ModelError, refusal

PIECE = 1 << 16  # bytes


class GatewayClient:
    """A client of HTTP at a unix socket, with a connection for each request.

    Args:
        path: Of the socket.
    """

    def __init__(self, path: str) -> None:
        self._path = path

    def ask(self, path: str, body: Mapping[str, Any] | None, seconds: float) -> object:
        """Return the JSON that the gateway answers to a request within some seconds.

        Raises:
            ModelError: It does not.
        """
        content, end = None if body is None else json.dumps(body), time.monotonic() + seconds
        headers = {"Content-Type": "application/json"}
        try:
            with closing(_SocketConnection(self._path, seconds)) as connection:
                connection.request("POST" if content else "GET", f"/v1{path}", content, headers)
                with connection.getresponse() as response:
                    answer = _read(response, end)
        except TimeoutError:
            raise ModelError(f"its server gave no answer within {seconds:g} s") from None
        except (OSError, HTTPException) as error:
            raise ModelError(f"its server cannot be reached: {error}") from None
        try:
            document: object = json.loads(answer)
        except (ValueError, RecursionError):
            document = None
        if response.status >= 300:
            raise refusal(response.status, document, response.getheader("Retry-After"))
        if document is None:
            raise ModelError("the server's answer is not JSON")
        return document

    def close(self) -> None:
        """Do nothing: there is no connection."""


class _SocketConnection(HTTPConnection):
    """A connection to a unix socket."""

    def __init__(self, path: str, seconds: float) -> None:
        super().__init__("model", timeout=None if isinf(seconds) else seconds)
        self._path = path

    def connect(self) -> None:
        """Connect."""
        self.sock = socket.socket(socket.AF_UNIX)
        self.sock.settimeout(self.timeout)
        self.sock.connect(self._path)


def _read(response: HTTPResponse, end: float) -> bytes:
    """Return the body of an answer.

    Raises:
        OSError: It does not end.
    """
    body = bytearray()
    while piece := response.read1(PIECE):
        body += piece
        if len(body) > LARGEST_ANSWER:
            raise OSError(f"the answer has more than {LARGEST_ANSWER:,} bytes")
        if time.monotonic() > end:
            raise TimeoutError
    return bytes(body)
