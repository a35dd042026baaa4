"""Where published documents are read from: a folder, or a web address."""

import time
from pathlib import Path
from typing import Protocol
from urllib.parse import urljoin, urlsplit

import httpx

from wildscav.errors import UserError, describe
from wildscav_engine.storage.files import read_limited
from wildscav_evaluator.output.layout import SEASON_FILE

LARGEST = 2 << 30  # bytes of a document
TIME = 60.0  # s for an answer
TRIES = 5  # at a download that breaks
PAUSE = 1.0  # s before the second one; it doubles each time
LONGEST_WAIT = 120.0  # s that a server may ask to wait
ON_SITE = f"api/v1/audit/{SEASON_FILE}"


class SourceError(UserError):
    """Something that is published cannot be read."""


class MissingError(SourceError):
    """It is not there."""


class Source(Protocol):
    """Where documents are."""

    name: str
    is_live: bool  # whether its documents may change while they are read

    def read(self, address: str, largest: int = LARGEST) -> bytes:
        """Return the document at an address relative to the season's document.

        Raises:
            SourceError: It cannot be read.
        """
        ...


class FolderSource:
    """Documents in a folder."""

    is_live = False

    def __init__(self, folder: Path) -> None:
        self._folder, self.name = folder.resolve(), str(folder)

    def read(self, address: str, largest: int = LARGEST) -> bytes:
        """Return a file of the folder. See ``Source``."""
        path = (self._folder / address).resolve()
        if not path.is_relative_to(self._folder):
            raise SourceError(f"{self.name}: the address {address} leads out of the folder")
        try:
            return read_limited(path, largest)
        except FileNotFoundError:
            raise MissingError(f"{path} is missing") from None
        except OSError as error:
            raise SourceError(describe(error)) from error


class WebSource:
    """Documents at a web address. It may be used from several threads.

    Args:
        address: Of the season's document.
    """

    is_live = True

    def __init__(self, address: str, client: httpx.Client) -> None:
        self.name, self._client = address, client
        self._answered = False  # whether there ever was an answer: then a broken connection is worth a wait

    def read(self, address: str, largest: int = LARGEST) -> bytes:
        """Download a document. See ``Source``."""
        url = urljoin(self.name, address)
        if urlsplit(url)[:2] != urlsplit(self.name)[:2]:
            raise SourceError(f"{self.name}: the address {address} leads to another host")
        pause = PAUSE
        for attempt in range(TRIES):
            try:
                return self._download(url, largest)
            except _TryAgainError as error:
                if attempt + 1 == TRIES or not self._answered:
                    raise SourceError(f"{url}: {error}") from None
                time.sleep(error.wait or pause)
                pause *= 2.0
        raise AssertionError

    def _download(self, url: str, largest: int) -> bytes:
        content = bytearray()
        try:
            with self._client.stream("GET", url) as response:
                self._answered = True
                _check_status(url, response)
                for part in response.iter_bytes():
                    content += part
                    if len(content) > largest:
                        raise SourceError(f"{url} has more than {largest:,} bytes")
        except (httpx.InvalidURL, httpx.UnsupportedProtocol, httpx.TooManyRedirects) as error:
            raise SourceError(f"{url} is no address of a season: {error}", 2) from None
        except httpx.HTTPError as error:
            raise _TryAgainError(str(error) or type(error).__name__) from None
        return bytes(content)


class _TryAgainError(Exception):
    """A download broke, and may work later."""

    def __init__(self, reason: str, wait: float = 0.0) -> None:
        super().__init__(reason)
        self.wait = wait  # s that the server asks to wait


def _check_status(url: str, response: httpx.Response) -> None:
    if response.status_code == httpx.codes.NOT_FOUND:
        raise MissingError(f"{url} does not exist")
    if response.status_code in (httpx.codes.TOO_MANY_REQUESTS, httpx.codes.SERVICE_UNAVAILABLE):
        wait = response.headers.get("Retry-After", "")
        seconds = float(wait) if wait.isdecimal() else 0.0
        raise _TryAgainError(f"the server answers {response.status_code}", min(seconds, LONGEST_WAIT))
    if response.is_server_error:
        raise _TryAgainError(f"the server answers {response.status_code}")
    if not response.is_success:
        raise SourceError(f"{url}: the server answers {response.status_code}")


def open_client() -> httpx.Client:
    """Return a client for a ``WebSource``."""
    return httpx.Client(timeout=TIME, follow_redirects=True, headers={"User-Agent": "wildscav-audit"})


def web_candidates(url: str) -> tuple[str, ...]:
    """Return where the season's document may be, given what people type: a season's page, or a folder.

    Raises:
        SourceError: It is no address.
    """
    try:
        parts = urlsplit(url)
    except ValueError as error:
        raise SourceError(f"{url} is no address: {error}", 2) from None
    if not parts.hostname:
        raise SourceError(f"{url} is no address: it names no host", 2)
    if parts.path.endswith(f"/{SEASON_FILE}"):
        return (url,)
    base = url if url.endswith("/") else f"{url}/"
    return urljoin(base, ON_SITE), urljoin(base, SEASON_FILE)
