"""Which addresses messages may be sent to: those on the public internet, unless the organizer allows more.

A competitor chooses where messages go. Nothing may reach the organizer's own network that way, so a name is
looked up once, all of its addresses are checked, and the connection goes to an address that was checked.
"""

import asyncio
import socket
from concurrent.futures import Future
from ipaddress import IPv4Address, IPv6Address, IPv6Network, ip_address
from threading import Thread
from typing import Any

Address = IPv4Address | IPv6Address
TRANSLATED = IPv6Network("64:ff9b::/96")  # NAT64, RFC 6052: the last 32 bits are an address of version 4


class RefusedAddressError(Exception):
    """A name cannot be looked up, or leads to an address that no message may go to."""


async def checked_addresses(host: str, port: int, *, private_addresses: bool) -> list[Address]:
    """Look a name up, once, and return its addresses.

    Args:
        host: A name or an address, in any form that the system understands: ``0x7f.1`` is 127.0.0.1.
        port: The port.
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
