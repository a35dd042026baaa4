"""Addresses as people type them, and the file of logins."""

import stat
from pathlib import Path

import pytest

from wildscav.errors import UserError
from wildscav_leaderboard.competing.connection import is_open_to_others, season_url
from wildscav_leaderboard.competing.logins import FILE, Login, Logins


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


FIRST, SECOND = "https://first.example.org", "https://second.example.org"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("WILDSCAV_CONFIG_DIR", str(tmp_path / "settings"))
    return tmp_path / "settings"


def login(token: str) -> Login:
    return Login(name="ada", title="The season", token=token)


def test_the_latest_login_is_the_current_one_and_the_one_before_it_after_logging_out() -> None:
    for url, token in ((FIRST, "one"), (SECOND, "two")):
        Logins.read().with_login(url, login(token)).save()
    both = Logins.read()
    assert (both.current, both.seasons[FIRST].token) == (SECOND, "one")
    both.without(SECOND).save()
    assert Logins.read().current == FIRST
    Logins.read().without(FIRST).save()
    assert (Logins.read().current, Logins.read().seasons) == (None, {})


def test_a_file_that_others_could_read_is_theirs_no_more_once_it_is_written(folder: Path) -> None:
    folder.mkdir()
    (folder / FILE).write_text('{"current": null, "seasons": {}}')
    (folder / FILE).chmod(0o644)
    Logins.read().with_login(FIRST, login("secret")).save()
    assert stat.S_IMODE((folder / FILE).stat().st_mode) == 0o600
    assert [path.name for path in folder.iterdir()] == [FILE]


@pytest.mark.parametrize("content", ["", "{", "[]", '{"seasons": {"x": 3}}', "\x00"])
def test_a_damaged_file_is_told_and_kept(folder: Path, content: str) -> None:
    folder.mkdir()
    (folder / FILE).write_text(content)
    with pytest.raises(UserError, match="is damaged: remove it, and log in again"):
        Logins.read()
    assert (folder / FILE).read_text() == content


def test_a_folder_that_cannot_be_written_is_told_in_one_line(folder: Path) -> None:
    folder.write_text("no folder")
    with pytest.raises(UserError):
        Logins.read().with_login(FIRST, login("one")).save()
