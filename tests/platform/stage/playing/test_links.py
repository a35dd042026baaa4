"""The secret links of a table."""

import pytest

from wildscav.errors import UserError
from wildscav_stage.playing.links import Links, base_of, checked_public_url


def test_each_seat_has_a_secret_of_its_own() -> None:
    links = Links(3)
    secrets = [links.of_seat(seat) for seat in range(3)]
    assert [links.seat_of(secret) for secret in secrets] == [0, 1, 2]
    assert len({*secrets, links.watching}) == 4
    assert all(len(secret) >= 22 for secret in secrets)  # 128 bits
    assert links.seat_of(links.watching) is None
    assert links.is_watching(links.watching)
    assert not links.is_watching(secrets[0])


@pytest.mark.parametrize("text", ["", "x", "ü", "\ud800", "x" * 10_000])
def test_anything_else_is_no_secret(text: str) -> None:
    links = Links(2)
    assert links.seat_of(text) is None
    assert not links.is_watching(text)


def test_a_link_ends_when_it_is_replaced() -> None:
    links = Links(2)
    old, other = links.of_seat(1), links.of_seat(0)
    links.renew(1)
    assert links.seat_of(old) is None
    assert links.was_replaced(old)
    assert links.seat_of(links.of_seat(1)) == 1
    assert links.seat_of(other) == 0


def test_invitations_lead_through_the_proxy_and_the_hosts_own_link_does_not() -> None:
    links = Links(2)
    base = base_of("127.0.0.1", 8000, checked_public_url("https://play.example.org"))
    addresses = base.addresses(links, 2)
    assert addresses.host == f"http://127.0.0.1:8000/play/{links.of_seat(0)}"
    assert addresses.guests == (f"https://play.example.org/play/{links.of_seat(1)}",)
    assert addresses.watch == f"https://play.example.org/watch/{links.watching}"
    assert not base.local_only


def test_links_of_the_loopback_interface_are_for_this_machine_only() -> None:
    assert base_of("127.0.0.1", 8000, None).local_only
    assert base_of("::1", 8000, None).local_only
    assert not base_of("192.0.2.7", 8000, None).local_only
    assert base_of("::", 8000, None).here == "http://[::1]:8000/"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "play.example.org",
        "ftp://example.org",
        "https://",
        "https://a/b",
        "https://a/?b",
        "https://u@a",
        "http://a:x",
        "http://ex ample",
        "http://[::1",
    ],
)
def test_what_is_no_url_of_a_proxy_is_said(text: str) -> None:
    with pytest.raises(UserError, match=r"--public-url is .*, must be like https://play\.example\.org"):
        checked_public_url(text)


def test_whoever_serves_a_table_may_give_the_first_seat_its_secret() -> None:
    links = Links(2, "known to a web server")
    assert links.seat_of("known to a web server") == 0
    assert links.seat_of(links.of_seat(1)) == 1
    assert links.of_seat(1) != links.of_seat(0)
