"""Asks a server by the official client of OpenAI's protocol, whose import takes a second."""

import json
import time
from collections.abc import Iterator, Mapping
from typing import Any

import httpx2
import openai

from wildscav.errors import UserError
from wildscav.harness.answers import LARGEST_ANSWER, ModelError, refusal

CONNECT_TIME = 10.0  # s
ANY_KEY = "none"  # since the client wants one


class OpenAIClient:
    """A client of a server with a URL.

    Args:
        url: Of the server, up to the version.
        key: Its key, or "".

    Raises:
        UserError: The URL is not valid.
    """

    def __init__(self, url: str, key: str) -> None:
        plain = {"Accept-Encoding": "identity"}  # so that the size of an answer is known before it is read
        try:
            self._client = openai.OpenAI(
                base_url=url,
                api_key=key or ANY_KEY,
                max_retries=0,  # ours are counted, logged, and end with the budget
                http_client=httpx2.Client(transport=BoundedTransport(), headers=plain),
            )
        except (ValueError, httpx2.InvalidURL) as error:
            raise UserError(f"the model's url {url!r} is not valid: {error}", 2) from None

    def ask(self, path: str, body: Mapping[str, Any] | None, seconds: float) -> object:
        """Return the JSON that the server answers to a request within some seconds.

        Raises:
            ModelError: It does not.
        """
        timeout = httpx2.Timeout(seconds, connect=min(CONNECT_TIME, seconds))
        options: Any = {"cast_to": httpx2.Response, "options": {"timeout": timeout}}
        try:
            response = (
                self._client.get(path, **options)
                if body is None
                else self._client.post(path, body=body, **options)
            )
            document: object = json.loads(response.content)
        except openai.APIStatusError as error:
            after = error.response.headers.get("retry-after")
            raise refusal(error.status_code, error.body, after) from None
        except openai.APITimeoutError:
            raise ModelError(f"its server gave no answer within {seconds:g} s") from None
        except openai.APIConnectionError as error:
            raise ModelError(f"its server cannot be reached: {error.__cause__ or error}") from None
        except (ValueError, RecursionError):
            raise ModelError("the server's answer is not JSON") from None
        return document

    def close(self) -> None:
        """Close all connections."""
        self._client.close()


class BoundedTransport(httpx2.HTTPTransport):
    """Connections on which answers end: after 8 MiB, or when the time for a read is over for all of them."""

    def handle_request(self, request: httpx2.Request) -> httpx2.Response:
        """Send a request, and return the answer, whose body is not read yet."""
        end = time.monotonic() + request.extensions["timeout"]["read"]
        response = super().handle_request(request)
        if response.headers.get("content-encoding", "identity") != "identity":
            raise httpx2.RemoteProtocolError("the answer is compressed, though none was asked to be")
        response.stream = _Bounded(response.stream, end)
        return response


class _Bounded(httpx2.SyncByteStream):
    """A body that ends."""

    def __init__(self, stream: Any, end: float) -> None:
        self._stream, self._end = stream, end

    def __iter__(self) -> Iterator[bytes]:
        size = 0
        for piece in self._stream:
            size += len(piece)
            if size > LARGEST_ANSWER:
                raise httpx2.RemoteProtocolError(f"the answer has more than {LARGEST_ANSWER:,} bytes")
            if time.monotonic() > self._end:
                raise httpx2.ReadTimeout("the answer does not end")
            yield piece

    def close(self) -> None:
        self._stream.close()
