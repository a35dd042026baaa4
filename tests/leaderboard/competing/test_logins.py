"""The file of logins."""

import stat
from pathlib import Path

import pytest

from wildscav.errors import UserError
from wildscav_leaderboard.competing.logins import FILE, Login, Logins

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
