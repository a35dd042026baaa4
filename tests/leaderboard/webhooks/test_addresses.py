"""Which addresses a message may go to."""

import asyncio
import socket
from ipaddress import ip_address
from typing import Any

import pytest

from wildscav_leaderboard.webhooks.sending import RefusedAddressError, checked_addresses, is_public


@pytest.mark.parametrize(
    ("address", "public"),
    [
        ("8.8.8.8", True),
        ("2606:4700::1111", True),
        ("::ffff:8.8.8.8", True),  # version 4 inside of version 6
        ("64:ff9b::808:808", True),  # and as networks without version 4 reach it
        ("127.0.0.1", False),
        ("127.200.0.9", False),
        ("0.0.0.0", False),  # noqa: S104
        ("10.1.2.3", False),
        ("172.16.0.1", False),
        ("192.168.1.1", False),
        ("169.254.169.254", False),  # where clouds answer with keys
        ("100.64.0.1", False),  # shared by the customers of a provider
        ("192.0.2.1", False),
        ("224.0.0.251", False),
        ("239.1.1.1", False),
        ("240.0.0.1", False),
        ("255.255.255.255", False),
        ("::", False),
        ("::1", False),
        ("fe80::1", False),
        ("fe80::1%1", False),
        ("fc00::1", False),
        ("fd12:3456::1", False),
        ("fec0::1", False),
        ("ff02::1", False),
        ("ff0e::1", False),
        ("2001:db8::1", False),
        ("::ffff:127.0.0.1", False),
        ("::ffff:10.0.0.1", False),
        ("::ffff:169.254.169.254", False),
        ("64:ff9b::7f00:1", False),
        ("64:ff9b::a00:1", False),
        ("2002:7f00:1::", False),  # 6to4 of 127.0.0.1
        ("2002:c0a8:101::1", False),
    ],
)
def test_public(address: str, public: bool) -> None:
    assert is_public(ip_address(address)) == public


@pytest.mark.parametrize(
    "host",
    [
        "localhost",
        "127.0.0.1",
        "2130706433",
        "0x7f000001",
        "0177.0.0.1",
        "127.1",
        "0x7f.1",
        "::ffff:127.0.0.1",
    ],
)
def test_no_way_to_write_this_machine_is_accepted(host: str) -> None:
    with pytest.raises(RefusedAddressError, match="not on the public internet"):
        asyncio.run(checked_addresses(host, 80, private_addresses=False))


def test_every_address_of_a_name_is_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(socket, "getaddrinfo", answering("8.8.8.8", "10.0.0.1"))

    with pytest.raises(RefusedAddressError):
        asyncio.run(checked_addresses("mixed.test", 80, private_addresses=False))
    allowed = asyncio.run(checked_addresses("mixed.test", 80, private_addresses=True))

    assert allowed == [ip_address("8.8.8.8"), ip_address("10.0.0.1")]


@pytest.mark.parametrize("host", ["nowhere.invalid", "a" * 64 + ".test", ".", "a..b"])
def test_a_name_that_leads_nowhere_is_refused(host: str) -> None:
    with pytest.raises(RefusedAddressError, match="cannot be looked up"):
        asyncio.run(checked_addresses(host, 80, private_addresses=True))


def answering(*addresses: str) -> Any:
    """Return a lookup that knows these addresses."""
    return lambda host, port, *_, **__: [
        (socket.AF_INET, socket.SOCK_STREAM, 6, "", (address, port)) for address in addresses
    ]
