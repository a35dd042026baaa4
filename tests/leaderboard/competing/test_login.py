"""Logging in: addresses as people type them, how a token is got and kept, and which season is meant."""

import stat
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.leaderboard.competing.season_site import PASSWORD, Competitor, Site, season_site

from wildscav.errors import UserError
from wildscav_leaderboard.accounts import passwords
from wildscav_leaderboard.competing.connection import is_open_to_others, season_url
from wildscav_leaderboard.competing.login import SHORTEST
from wildscav_leaderboard.competing.logins import FILE, Login, Logins


@pytest.fixture(scope="module")
def invited(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Site]:
    """A second season, for invited people."""
    with season_site(tmp_path_factory.mktemp("invited"), registration="invited") as one:
        yield one


def kept() -> Logins:
    return Logins.read()


def test_a_new_account_is_logged_in_and_its_token_is_for_the_owners_eyes(competitor: Competitor) -> None:
    told = competitor.told("login", competitor.site.url, "--register", "--name", "ada", stdin=f"{PASSWORD}\n")

    token = kept().seasons[competitor.site.url].token
    assert "ada" in told
    assert token.startswith("wildscav_")
    assert token not in told
    assert PASSWORD not in kept().path.read_text()
    assert stat.S_IMODE(kept().path.stat().st_mode) == 0o600
    assert stat.S_IMODE(kept().path.parent.stat().st_mode) == 0o700


def test_a_name_and_a_password_get_a_token_and_a_wrong_password_changes_nothing(
    competitor: Competitor,
) -> None:
    competitor.site.token("bob")

    as_bob = ("login", competitor.site.url, "--name", "bob")
    assert competitor.refused(*as_bob, stdin="no idea\n") == "wildscav: the name or the password is wrong\n"
    assert not kept().path.exists()

    competitor.told(*as_bob, stdin=f"{PASSWORD}\n")
    assert kept().seasons[competitor.site.url].name == "bob"


def test_the_shortest_password_that_is_asked_for_is_one_that_seasons_take() -> None:
    assert SHORTEST == passwords.SHORTEST


def test_a_misspelt_latest_is_suggested(competitor: Competitor) -> None:
    assert "(did you mean 'latest'?)" in competitor.refused("leaderboard", "--season", "latest.invalid")


def test_json_names_the_account_and_not_the_token(competitor: Competitor) -> None:
    token = competitor.site.token("carol", "crows")
    account = competitor.document("login", competitor.site.url, "--token", token)["account"]
    assert (account["team"]["name"], account["quota"]["left_today"]) == ("crows", 3)
    assert token not in str(account)


def test_logging_out_revokes_the_token(competitor: Competitor) -> None:
    token = competitor.site.token("dave")
    competitor.run("login", competitor.site.url, "--token", token)

    assert competitor.document("login", "--logout") == {"url": competitor.site.url, "revoked": True}

    assert token not in kept().path.read_text()
    again = competitor.refused("login", competitor.site.url, "--token", token)
    assert "this token is unknown or revoked" in again
    assert "you are logged in to no season" in competitor.run("team", "show").stderr


def test_an_invitation_is_needed_where_registration_is_not_open(
    competitor: Competitor, invited: Site
) -> None:
    register = ("login", invited.url, "--register", "--name", "erin")
    wrong = competitor.refused(*register, "--invitation", "invite_wrong", stdin=PASSWORD)
    assert "this invitation is unknown, used up or expired" in wrong

    competitor.told(*register, "--invitation", invited.invitation(), stdin=f"{PASSWORD}\n")


@pytest.mark.parametrize("missing", ["--name", "--invitation"])
def test_standard_input_is_read_for_the_password_alone(
    competitor: Competitor, invited: Site, missing: str
) -> None:
    given = {"--name": "fred", "--invitation": "invite_key"}
    del given[missing]
    options = [word for option in given.items() for word in option]

    register = ("login", invited.url, "--register", *options)
    refused = competitor.refused(*register, code=2, stdin=f"{PASSWORD}\n")
    assert refused == f"wildscav: {missing} is missing: standard input is read for the password alone\n"


def test_commands_are_about_the_season_logged_in_to_last_unless_one_is_named(
    competitor: Competitor, invited: Site, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = competitor.site, invited
    competitor.run("login", first.url, "--token", first.token("frank", "falcons"))
    competitor.run("login", second.url, "--token", second.token("frank", "finches"))

    def team(*options: str) -> str:
        return str(competitor.document("team", "show", *options)["team"]["name"])

    assert team() == "finches"
    assert team("--season", first.url) == "falcons"
    monkeypatch.setenv("WILDSCAV_SEASON", first.url)
    assert team() == "falcons"
    monkeypatch.delenv("WILDSCAV_SEASON")
    # A login that is still valid needs no password again.
    competitor.told("login", first.url)
    assert team() == "falcons"
    competitor.run("login", "--logout")
    assert team() == "finches"


def test_a_token_in_the_environment_is_used_where_nothing_may_be_stored(
    competitor: Competitor, monkeypatch: pytest.MonkeyPatch
) -> None:
    token = competitor.site.token("grace", "geese")
    monkeypatch.setenv("WILDSCAV_SEASON", competitor.site.url)
    monkeypatch.setenv("WILDSCAV_TOKEN", token)  # a seat's, which agents are given
    assert competitor.run("team", "show").returncode != 0

    monkeypatch.setenv("WILDSCAV_ACCOUNT_TOKEN", token)
    assert "geese" in competitor.run("team", "show").stdout
    assert not kept().path.exists()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--invitation", "x"], "--invitation is for a new account: add --register"),
        (["--register", "--token", "x"], "--token is for an account that there is"),
        (["--token", "a token"], "this is not a token"),
        (["--name", "bob"], "there is no password"),
    ],
)
def test_options_that_do_not_fit_are_refused(competitor: Competitor, arguments: list[str], says: str) -> None:
    assert says in competitor.refused("login", competitor.site.url, *arguments, code=2)
    assert not kept().path.exists()


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


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("WILDSCAV_CONFIG_DIR", str(tmp_path / "settings"))
    return tmp_path / "settings"


def login(token: str) -> Login:
    return Login(name="ada", title="The season", token=token)


@pytest.mark.usefixtures("folder")
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
