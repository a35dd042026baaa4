"""Addresses as people type them."""

import pytest

from wildscav.errors import UserError
from wildscav_leaderboard.competing.connection import is_open_to_others, season_url


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("https://season.example.org", "https://season.example.org"),
        ("https://season.example.org/", "https://season.example.org"),
        (" season.example.org ", "https://season.example.org"),
        ("Season.Example.ORG:443", "https://season.example.org"),
        ("http://season.example.org:8000", "http://season.example.org:8000"),
        ("127.0.0.1:8000", "http://127.0.0.1:8000"),  # this machine needs no TLS
        ("localhost:8000", "http://localhost:8000"),
        ("https://localhost:8000", "https://localhost:8000"),
        ("[::1]:8000", "http://[::1]:8000"),
    ],
)
def test_one_season_has_one_address(typed: str, meant: str) -> None:
    assert season_url(typed) == meant
    assert season_url(meant) == meant


@pytest.mark.parametrize(
    "typed",
    [
        *("", "https://", "ftp://season.example.org", "http://[::1", "host:port", "host:99999", "two words"),
        *("https://name:password@season.example.org", "https://season.example.org/boards", "host?x=1"),
        *("a\nb", "https://\x1b[2J"),
    ],
)
def test_what_is_no_address_is_refused(typed: str) -> None:
    with pytest.raises(UserError) as caught:
        season_url(typed)
    assert caught.value.exit_code == 2


@pytest.mark.parametrize(
    ("url", "is_open"),
    [
        ("http://season.example.org", True),
        ("https://season.example.org", False),
        ("http://127.0.0.1:8000", False),
    ],
)
def test_what_is_sent_without_tls_can_be_read_on_the_way(url: str, is_open: bool) -> None:
    assert is_open_to_others(url) == is_open
