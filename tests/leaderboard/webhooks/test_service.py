"""What a team may do with webhooks, and which addresses a message may go to."""

import asyncio
import socket
from ipaddress import ip_address

import pytest
from standardwebhooks import Webhook as Signer
from tests.leaderboard.seasons_made import NOON, team_with_member

from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.refusals import InvalidError, NotFoundError, RefusalError
from wildscav_leaderboard.webhooks.sending import RefusedAddressError, checked_addresses, is_public
from wildscav_leaderboard.webhooks.service import (
    MAX_WEBHOOKS,
    add_webhook,
    own_webhook,
    queue_message,
    remove_webhook,
    webhooks_of,
)


@pytest.mark.parametrize(
    ("url", "reason"),
    [
        ("ftp://example.org/", "must begin with https:// or http://"),
        *((url, "must begin with") for url in ("example.org", "", "https://", "https:///hook")),
        *((f"https://example.org{rest}", "must begin with") for rest in ("/\x1b[2J", ":port/")),
        ("https://example.org/" + "a" * 500, "at most 500 characters"),
        ("http://192.0.2.1:70000/x", "the port of a webhook is 70000, must be 1 to 65535"),
        ("http://192.0.2.1:0/x", "must be 1 to 65535"),
        *(
            (f"http://xn--{rest}", "the name in the address of a webhook is not valid")
            for rest in ("a/", "/")
        ),
        ("https://me:secret@example.org/", "must not contain a name or a password"),
    ],
)
def test_what_is_no_address_of_a_receiver_is_refused(database: Database, url: str, reason: str) -> None:
    with database.writing() as session:
        foxes, _ = team_with_member(session, "foxes")
        with pytest.raises(InvalidError, match=reason):
            add_webhook(session, foxes, url, NOON)


def test_a_team_has_a_few_webhooks_each_with_a_secret_of_its_own(database: Database) -> None:
    with database.writing() as session:
        foxes, _ = team_with_member(session, "foxes")
        owls, _ = team_with_member(session, "owls")
        urls = [f"https://example.org/{number}" for number in range(MAX_WEBHOOKS)]
        added = [add_webhook(session, foxes, url, NOON) for url in urls]
        with pytest.raises(RefusalError, match="at most 5 webhooks"):
            add_webhook(session, foxes, "https://example.org/more", NOON)
        assert len({one.secret for one in added}) == MAX_WEBHOOKS
        assert Signer(added[0].secret).sign("msg_1", NOON, "{}").startswith("v1,")
        assert webhooks_of(session, foxes) == added
        assert webhooks_of(session, owls) == []


def test_the_webhook_of_another_team_does_not_exist(database: Database) -> None:
    with database.writing() as session:
        foxes, _ = team_with_member(session, "foxes")
        owls, _ = team_with_member(session, "owls")
        webhook = add_webhook(session, foxes, "https://example.org/", NOON)
        for attempt in (own_webhook, remove_webhook):
            with pytest.raises(NotFoundError, match=f"your team has no webhook {webhook.id}"):
                attempt(session, owls, webhook.id)
        assert queue_message(session, owls.id, "submission.active", {}, NOON) == []
        assert webhooks_of(session, foxes) == [webhook]


PUBLIC = (
    *("8.8.8.8", "2606:4700::1111"),
    "::ffff:8.8.8.8",  # version 4 inside of version 6
    "64:ff9b::808:808",  # and as networks without version 4 reach it
)
PRIVATE = (
    *("127.0.0.1", "127.200.0.9", "0.0.0.0", "10.1.2.3", "172.16.0.1", "192.168.1.1"),  # noqa: S104
    "169.254.169.254",  # where clouds answer with keys
    "100.64.0.1",  # shared by the customers of a provider
    *("192.0.2.1", "224.0.0.251", "239.1.1.1", "240.0.0.1", "255.255.255.255"),
    *("::", "::1", "fe80::1", "fe80::1%1", "fc00::1", "fd12:3456::1", "fec0::1", "ff02::1", "ff0e::1"),
    *("2001:db8::1", "::ffff:127.0.0.1", "::ffff:10.0.0.1", "::ffff:169.254.169.254"),
    *("64:ff9b::7f00:1", "64:ff9b::a00:1"),
    *("2002:7f00:1::", "2002:c0a8:101::1"),  # 6to4 of 127.0.0.1 and 192.168.1.1
)


@pytest.mark.parametrize("address", [*PUBLIC, *PRIVATE])
def test_public(address: str) -> None:
    assert is_public(ip_address(address)) == (address in PUBLIC)


@pytest.mark.parametrize(
    "host",
    [
        *("localhost", "127.0.0.1", "2130706433", "0x7f000001", "0177.0.0.1", "127.1", "0x7f.1"),
        "::ffff:127.0.0.1",
    ],
)
def test_no_way_to_write_this_machine_is_accepted(host: str) -> None:
    with pytest.raises(RefusedAddressError, match="not on the public internet"):
        asyncio.run(checked_addresses(host, 80, private_addresses=False))


def test_every_address_of_a_name_is_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    found = [(socket.AF_INET, socket.SOCK_STREAM, 6, "", (one, 80)) for one in ("8.8.8.8", "10.0.0.1")]
    monkeypatch.setattr(socket, "getaddrinfo", lambda *_, **__: found)
    with pytest.raises(RefusedAddressError):
        asyncio.run(checked_addresses("mixed.test", 80, private_addresses=False))
    allowed = asyncio.run(checked_addresses("mixed.test", 80, private_addresses=True))

    assert allowed == [ip_address("8.8.8.8"), ip_address("10.0.0.1")]


@pytest.mark.parametrize("host", ["nowhere.invalid", "a" * 64 + ".test", ".", "a..b"])
def test_a_name_that_leads_nowhere_is_refused(host: str) -> None:
    with pytest.raises(RefusedAddressError, match="cannot be looked up"):
        asyncio.run(checked_addresses(host, 80, private_addresses=True))
