"""Requests to a season, and what can go wrong with them: refusals, silence, wrong servers, certificates."""

import json
import ssl
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from http import HTTPStatus
from ipaddress import ip_address
from typing import Any
from urllib.parse import urlsplit

import httpx

from wildscav.errors import UserError
from wildscav.version import __version__

PORTS = {"http": 80, "https": 443}


def season_url(text: str) -> str:
    """Return the address of a season, such as ``https://season.example.org``.

    Without a scheme, it is https; http for this machine.

    Raises:
        UserError: It is no address of a season.
    """
    text = text.strip()
    scheme, _, rest = text.rpartition("://")
    try:
        parts = urlsplit(f"{scheme or 'https'}://{rest}")
        host, port = parts.hostname, parts.port
    except ValueError:
        host = port = None
    if not host or parts.scheme not in PORTS or not text.isprintable() or " " in text:
        raise UserError(f"{text!r} is no address of a season, such as https://season.example.org", 2)
    if parts.username is not None or parts.path.strip("/") or parts.query or parts.fragment:
        raise UserError(
            f"{text!r} is more than the address of a season: give only its host, such as "
            f"{parts.scheme}://{host}",
            exit_code=2,
        )
    chosen = parts.scheme if scheme or not is_this_machine(host) else "http"
    shown = f"[{host}]" if ":" in host else host
    return f"{chosen}://{shown}" + ("" if port in (None, PORTS[chosen]) else f":{port}")


def is_this_machine(host: str) -> bool:
    """Return whether a host is this machine's own."""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost" or host.endswith(".localhost")


def is_open_to_others(url: str) -> bool:
    """Return whether others on the way to an address can read what is sent there."""
    parts = urlsplit(url)
    return parts.scheme == "http" and not is_this_machine(parts.hostname or "")


class AnswerError(UserError):
    """The season refused a request.

    Args:
        message: Why, in the season's words.
    """

    def __init__(self, message: str, status: int) -> None:
        super().__init__(message)
        self.status = status

    @property
    def is_passing(self) -> bool:
        """Whether the same request may succeed in a moment."""
        return self.status in (HTTPStatus.TOO_MANY_REQUESTS, HTTPStatus.SERVICE_UNAVAILABLE)


class UnreachableError(UserError):
    """No answer came from a season's address."""


class NoSeasonError(UserError):
    """What answers at an address is not a season."""


def explained(error: httpx.HTTPError, url: str) -> UserError:
    """Return an error of a connection in our words."""
    cause = _root(error)
    if isinstance(cause, ssl.SSLCertVerificationError):
        return UserError(
            f"the certificate of {url} is not trusted: {cause.verify_message}; if it is the organizers' own, "
            "name their certificate's file in SSL_CERT_FILE"
        )
    if isinstance(cause, ssl.SSLError):
        return NoSeasonError(
            f"{url} does not speak TLS ({cause.reason}): does its address begin with http://?"
        )
    if isinstance(error, httpx.TimeoutException):
        return UnreachableError(f"{url} does not answer in time")
    if isinstance(error, httpx.RemoteProtocolError | httpx.DecodingError):
        return UnreachableError(f"{url} ended the connection, or does not speak HTTP: {error}")
    reason = getattr(cause, "strerror", None) or str(error) or type(error).__name__
    return UnreachableError(f"cannot reach {url}: {reason}")


def _root(error: BaseException) -> BaseException:
    """Return what caused an error in the first place."""
    seen = [error]
    while (cause := seen[-1].__cause__ or seen[-1].__context__) is not None and cause not in seen:
        seen.append(cause)
    known = (ssl.SSLError, OSError)
    return next((one for one in reversed(seen) if isinstance(one, known)), error)


API = "/api/v1"
LARGEST_ANSWER = 64 << 20  # bytes of a document
LONGEST_REASON = 500  # characters
# What a proxy answers when the season behind it does not.
DOWN = (HTTPStatus.BAD_GATEWAY, HTTPStatus.SERVICE_UNAVAILABLE, HTTPStatus.GATEWAY_TIMEOUT)
TIMEOUT = httpx.Timeout(60.0, connect=15.0)  # s
PATIENT = httpx.Timeout(600.0, connect=15.0)  # s; an archive is unpacked and checked before the answer
Query = Mapping[str, str | int | list[str] | None]


class Connection:
    """Sends requests to a season as one account, or as a visitor."""

    def __init__(self, url: str, token: str | None = None) -> None:
        self.url = url
        headers = {"User-Agent": f"wildscav/{__version__}", "Accept": "application/json"}
        if token is not None:
            headers["Authorization"] = f"Bearer {_checked(token)}"
        parts = urlsplit(url)
        try:
            self._client = httpx.Client(
                base_url=f"{url}{API}",
                headers=headers,
                timeout=TIMEOUT,
                verify=_certificates() if parts.scheme == "https" else True,
                trust_env=not is_this_machine(parts.hostname or ""),  # proxies
            )
        except (httpx.InvalidURL, ImportError, ValueError) as error:
            raise UserError(f"cannot reach {url}: {error}") from None

    def __enter__(self) -> "Connection":
        return self

    def __exit__(self, *_: object) -> None:
        self._client.close()

    def get(self, path: str, query: Query | None = None) -> Any:
        """Return the document at a path.

        Raises:
            UserError: The season refuses, or does not answer; one line says why.
        """
        return self.ask("GET", path, query=query)

    def ask(self, method: str, path: str, *, query: Query | None = None, content: object = None) -> Any:
        """Send a request, and return the document in the answer; None if it is empty.

        Raises:
            UserError: As in ``get``.
        """
        with self.stream(method, path, query=query, json=content) as response:
            return _document(read(response), self.url)

    def text(self, path: str) -> str:
        """Return the text at a path.

        Raises:
            UserError: As in ``get``.
        """
        with self.stream("GET", path) as response:
            return read(response).decode("utf-8", "replace")

    def upload(self, path: str, query: Query, pieces: Iterable[bytes], size: int) -> Any:
        """Send a file piece by piece, and return the document in the answer.

        Raises:
            UserError: As in ``get``.
        """
        headers = {"Content-Type": "application/octet-stream", "Content-Length": str(size)}
        settings: dict[str, Any] = {"content": pieces, "headers": headers, "timeout": PATIENT}
        try:
            with self.stream("POST", path, query=query, **settings) as response:
                return _document(read(response), self.url)
        except UnreachableError as error:
            raise UnreachableError(f"{error}; `wildscav team submissions` tells whether it arrived") from None

    @contextmanager
    def stream(
        self, method: str, path: str, *, query: Query | None = None, **settings: Any
    ) -> Iterator[httpx.Response]:
        """Send a request, and give the answer before its content is read.

        Raises:
            UserError: As in ``get``.
        """
        given = {name: value for name, value in (query or {}).items() if value is not None}
        try:
            with self._client.stream(method, path, params=given, **settings) as response:
                _check(response, self.url)
                yield response
        except httpx.HTTPError as error:
            raise explained(error, self.url) from None


def read(response: httpx.Response) -> bytes:
    """Return the content of an answer.

    Raises:
        NoSeasonError: It is larger than anything a season answers.
    """
    content = bytearray()
    for piece in response.iter_bytes():
        content += piece
        if len(content) > LARGEST_ANSWER:
            raise NoSeasonError(f"the answer has more than {LARGEST_ANSWER >> 20} MiB, as no season's has")
    return bytes(content)


def _checked(token: str) -> str:
    """Return a token that can stand in a header."""
    token = token.strip()
    if not token or not token.isascii() or not token.isprintable() or " " in token:
        raise UserError("this is not a token: it has characters that no token has", exit_code=2)
    return token


def _certificates() -> ssl.SSLContext:
    """Return what is trusted: the system's authorities, those in SSL_CERT_FILE, and certifi's."""
    import certifi

    context = ssl.create_default_context()
    context.load_verify_locations(certifi.where())
    return context


def _check(response: httpx.Response, url: str) -> None:
    """Check that a season answered, and did what it was asked for."""
    if response.is_success:
        return
    if response.is_redirect:
        target = urlsplit(response.headers.get("Location", ""))
        where = f" to {target.scheme}://{target.netloc}" if target.netloc else ""
        raise NoSeasonError(f"{url} redirects{where}: log in there, if you trust it")
    reason, status = _reason(read(response)), response.status_code
    if reason is None and status in DOWN:
        message = f"the season at {url} is down: HTTP status {status}"
        raise AnswerError(message, HTTPStatus.SERVICE_UNAVAILABLE)
    if reason is None:
        raise NoSeasonError(f"there is no season of Wildscav at {url}: HTTP status {status}")
    raise AnswerError(reason, status)


def _reason(content: bytes) -> str | None:
    """Return why a season refused; None if this is no answer of a season."""
    try:
        found = json.loads(content)["error"]
    except (ValueError, TypeError, LookupError, RecursionError):
        return None
    return found[:LONGEST_REASON] if isinstance(found, str) else None


def _document(content: bytes, url: str) -> Any:
    if not content:
        return None
    try:
        return json.loads(content)
    except (ValueError, RecursionError):
        raise NoSeasonError(f"there is no season of Wildscav at {url}: its answer is no document") from None
