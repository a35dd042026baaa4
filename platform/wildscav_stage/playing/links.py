"""The secret links by which people come to their seats, and spectators to theirs."""

import secrets
import socket
from typing import NamedTuple
from urllib.parse import urlsplit

from wildscav.errors import UserError
from wildscav_engine.view.web import LOOPBACK, link_to
from wildscav_server.endpoints.addresses import is_site

WILDCARDS = ("0.0.0.0", "::")  # noqa: S104 - only compared
ELSEWHERE = ("192.0.2.1", 9)  # an address of documentation, to which nothing is ever sent
SECRET_BYTES = 16


class Links:
    """The secret of each person's seat, the first of which may be known already, and that of spectators."""

    def __init__(self, seats: int, first: str | None = None) -> None:
        self._secrets = [first or new_secret(), *(new_secret() for _ in range(1, seats))]
        self._replaced: set[str] = set()
        self.watching = new_secret()

    def of_seat(self, seat: int) -> str:
        """Return the secret of a seat."""
        return self._secrets[seat]

    def seat_of(self, text: str) -> int | None:
        """Return the seat whose secret a text is; None if it is none."""
        found = None
        for seat, secret in enumerate(self._secrets):
            if _equal(text, secret):
                found = seat
        return found

    def is_watching(self, text: str) -> bool:
        """Return whether a text is the secret of spectators."""
        return _equal(text, self.watching)

    def opens_match(self, text: str) -> bool:
        """Return whether a text is the secret of spectators or of a seat, whose person may watch, too."""
        return self.is_watching(text) or self.seat_of(text) is not None

    def renew(self, seat: int) -> None:
        """Replace the secret of a seat by another one."""
        self._replaced.add(self._secrets[seat])
        self._secrets[seat] = new_secret()

    def was_replaced(self, text: str) -> bool:
        """Return whether a text was the secret of a seat."""
        return text in self._replaced


class Addresses(NamedTuple):
    """The links of a table, as people open them."""

    host: str  # the link of whoever started the table
    guests: tuple[str, ...]  # those of the other people
    watch: str  # that of spectators
    entrance: str = ""  # where whoever has the code takes a free seat; it names the code


class Base(NamedTuple):
    """Where a web server is reached: on its own machine, and from others."""

    here: str  # a URL that ends with a slash
    invited: str  # likewise, for links that are sent to others

    @property
    def local_only(self) -> bool:
        """Whether only this machine can open the links."""
        name = urlsplit(self.invited).hostname or ""
        return name in (LOOPBACK, "::1", "localhost")

    def addresses(self, links: Links, people: int) -> Addresses:
        """Return the present links of a table."""
        guests = tuple(self.invitation(links, seat) for seat in range(1, people))
        return Addresses(f"{self.here}play/{links.of_seat(0)}", guests, self.watching(links))

    def invitation(self, links: Links, seat: int) -> str:
        """Return the link that is sent to whoever is to have a seat."""
        return f"{self.invited}play/{links.of_seat(seat)}"

    def watching(self, links: Links) -> str:
        """Return the link that is sent to spectators."""
        return f"{self.invited}watch/{links.watching}"

    def entrance(self, code: str) -> str:
        """Return the link that is sent to whoever may come, with the code in it."""
        return f"{self.invited}join?code={code}"


def base_of(host: str, port: int, public_url: str | None) -> Base:
    """Return where a web server that listens on an address is reached."""
    here = link_to(host, port)
    if public_url is not None:
        return Base(here, public_url)
    return Base(here, link_to(_own_address(host) if host in WILDCARDS else host, port))


def checked_public_url(text: str) -> str:
    """Return the URL of the root of a proxy, with a slash at its end.

    Raises:
        UserError: It is none.
    """
    if not is_site(text) or (parts := urlsplit(text)).path not in ("", "/"):
        raise UserError(
            f"--public-url is {text!r}, must be like https://play.example.org, without a path", exit_code=2
        )
    return f"{parts.scheme}://{parts.netloc}/"


def _own_address(wildcard: str) -> str:
    """Return the address of this machine in its network; without one, the wildcard itself."""
    if ":" in wildcard:
        return wildcard
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(ELSEWHERE)  # chooses a network, and sends nothing
        except OSError:
            return wildcard
        return str(probe.getsockname()[0])


def new_secret() -> str:
    """Return a secret for a link."""
    return secrets.token_urlsafe(SECRET_BYTES)


def _equal(text: str, secret: str) -> bool:
    return secrets.compare_digest(text.encode(errors="replace"), secret.encode())
