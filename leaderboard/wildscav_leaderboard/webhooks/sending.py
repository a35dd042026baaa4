"""One attempt to send a message to a webhook over HTTP, and to which addresses messages may go.

Messages are signed as https://www.standardwebhooks.com says.
"""

import asyncio
import json
import socket
from concurrent.futures import Future
from dataclasses import dataclass
from datetime import datetime
from http import HTTPStatus
from ipaddress import IPv4Address, IPv6Address, IPv6Network, ip_address
from threading import Thread
from typing import Any

import httpx
from standardwebhooks import Webhook as Signer

from wildscav.version import __version__

Address = IPv4Address | IPv6Address
TRANSLATED = IPv6Network("64:ff9b::/96")  # NAT64, RFC 6052: the last 32 bits are an address of version 4


class RefusedAddressError(Exception):
    """A name cannot be looked up, or leads to an address that no message may go to."""


async def checked_addresses(host: str, port: int, *, private_addresses: bool) -> list[Address]:
    """Look a name up, once, and return its addresses.

    Args:
        host: A name or an address, in any form that the system understands: ``0x7f.1`` is 127.0.0.1.
        private_addresses: Whether they may be in private networks.

    Raises:
        RefusedAddressError: There are none, or one of them is not allowed.
    """
    try:
        found = await _looked_up(host, port)
    except (OSError, UnicodeError):
        raise RefusedAddressError("the name cannot be looked up") from None
    addresses = list(dict.fromkeys(ip_address(entry[4][0]) for entry in found))
    for address in addresses:
        if not private_addresses and not is_public(address):
            raise RefusedAddressError(
                "the name leads to an address that is not on the public internet, which this season's "
                "organizer does not allow"
            )
    return addresses


async def _looked_up(host: str, port: int) -> list[Any]:
    """Look a name up in a thread of its own: a slow name keeps no other one, and no end, waiting."""
    found: Future[list[Any]] = Future()

    def look_up() -> None:
        if not found.set_running_or_notify_cancel():
            return
        try:
            found.set_result(socket.getaddrinfo(host, port, type=socket.SOCK_STREAM))
        except Exception as error:  # noqa: BLE001 (whoever waits gets it)
            found.set_exception(error)

    Thread(target=look_up, daemon=True).start()
    return await asyncio.wrap_future(found)


def is_public(address: Address) -> bool:
    """Return whether an address is of one machine on the public internet."""
    inner = _inner(address)
    if inner is not None:
        return is_public(inner)
    if isinstance(address, IPv6Address) and address.is_site_local:
        return False
    return address.is_global and not address.is_multicast and not address.is_reserved


def _inner(address: Address) -> IPv4Address | None:
    """Return the address of version 4 that packets to an address of version 6 are sent on to, if any."""
    if isinstance(address, IPv4Address):
        return None
    if address in TRANSLATED:
        return IPv4Address(int(address) & 0xFFFF_FFFF)
    return address.ipv4_mapped or address.sixtofour


TIME = 10.0  # s for an attempt, from looking up the name to the status of the answer
CONNECT_TIME = 4.0  # s for each of the addresses


@dataclass(frozen=True)
class Message:
    """A message that is to be sent now."""

    delivery: int
    webhook: int
    event: str  # its identifier, equal in all attempts
    url: str
    secret: str
    payload: dict[str, Any]


@dataclass(frozen=True)
class Answer:
    """How an attempt went."""

    delivery: int
    problem: str = ""  # in one line; empty if the message arrived
    is_gone: bool = False  # whether the receiver says that it wants no more messages, ever


def open_client() -> httpx.AsyncClient:
    """Return a client with neither proxies nor passwords of this machine's user; SSL_CERT_FILE counts.

    It keeps no connection, because the next one to the same address may be to another name.
    """
    return httpx.AsyncClient(
        verify=httpx.create_ssl_context(),
        trust_env=False,
        timeout=httpx.Timeout(TIME, connect=CONNECT_TIME),
        limits=httpx.Limits(max_keepalive_connections=0),
    )


async def send(
    client: httpx.AsyncClient, message: Message, now: datetime, *, private_addresses: bool
) -> Answer:
    """Send a message, and return how it went, whatever goes wrong."""
    try:
        async with asyncio.timeout(TIME):
            status = await _post(client, message, now, private_addresses)
    except (TimeoutError, httpx.TimeoutException):
        return Answer(message.delivery, f"there was no answer within {TIME:.0f} s")
    except RefusedAddressError as error:
        return Answer(message.delivery, str(error))
    except Exception as error:  # noqa: BLE001 (whatever a team's address causes is that team's alone)
        while isinstance(error, ExceptionGroup):
            error = error.exceptions[0]
        reason = " ".join(str(error).split())[:200]
        return Answer(message.delivery, f"it cannot be reached: {reason or type(error).__name__}")
    if 200 <= status < 300:
        return Answer(message.delivery)
    return Answer(message.delivery, f"it answered with status {status}", is_gone=status == HTTPStatus.GONE)


async def _post(client: httpx.AsyncClient, message: Message, now: datetime, private_addresses: bool) -> int:
    """Return the status of the answer to a message; nothing else of the answer is read."""
    url = httpx.URL(message.url)
    port = url.port or (443 if url.scheme == "https" else 80)
    addresses = await checked_addresses(url.host, port, private_addresses=private_addresses)
    body = json.dumps(message.payload, separators=(",", ":"))
    headers = {
        "host": url.netloc.decode("ascii"),
        "content-type": "application/json",
        "user-agent": f"wildscav/{__version__}",
        "webhook-id": message.event,
        "webhook-timestamp": str(int(now.timestamp())),
        "webhook-signature": Signer(message.secret).sign(message.event, now, body),
    }
    for address in addresses:
        try:
            return await _post_to(client, url, address, headers, body)
        except (httpx.ConnectError, httpx.ConnectTimeout):
            if address == addresses[-1]:
                raise
    raise RefusedAddressError("the name has no addresses")


async def _post_to(
    client: httpx.AsyncClient, url: httpx.URL, address: Address, headers: dict[str, str], body: str
) -> int:
    """Send a request to an address that was checked; TLS and headers have the name of the webhook."""
    there = url.copy_with(host=str(address), username=None, password=None)
    named = {"sni_hostname": url.host}
    async with client.stream("POST", there, headers=headers, content=body, extensions=named) as response:
        return response.status_code
