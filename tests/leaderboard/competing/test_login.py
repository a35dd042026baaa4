"""Logging in: how a token is got, where it is kept, and which season is meant afterwards."""

import json
import stat
from collections.abc import Iterator

import pytest
from tests.leaderboard.competing.season_site import PASSWORD, Competitor, Site, season_site

from wildscav_leaderboard.competing.logins import Logins


@pytest.fixture(scope="module")
def invited(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Site]:
    """A second season, for invited people."""
    with season_site(tmp_path_factory.mktemp("invited"), registration="invited") as one:
        yield one


def kept() -> Logins:
    return Logins.read()


def test_a_new_account_is_logged_in_and_its_token_is_for_the_owners_eyes(competitor: Competitor) -> None:
    done = competitor.run("login", competitor.site.url, "--register", "--name", "ada", stdin=f"{PASSWORD}\n")

    assert done.returncode == 0, done.stderr
    assert "ada" in done.stdout
    token = kept().seasons[competitor.site.url].token
    assert token.startswith("wildscav_")
    assert token not in done.stdout + done.stderr
    assert PASSWORD not in kept().path.read_text()
    assert stat.S_IMODE(kept().path.stat().st_mode) == 0o600
    assert stat.S_IMODE(kept().path.parent.stat().st_mode) == 0o700


def test_a_name_and_a_password_get_a_token_and_a_wrong_password_changes_nothing(
    competitor: Competitor,
) -> None:
    competitor.site.token("bob")

    wrong = competitor.run("login", competitor.site.url, "--name", "bob", stdin="no idea\n")
    assert (wrong.returncode, wrong.stderr) == (1, "wildscav: the name or the password is wrong\n")
    assert not kept().path.exists()

    done = competitor.run("login", competitor.site.url, "--name", "bob", stdin=f"{PASSWORD}\n")
    assert done.returncode == 0, done.stderr
    assert kept().seasons[competitor.site.url].name == "bob"


def test_json_names_the_account_and_not_the_token(competitor: Competitor) -> None:
    token = competitor.site.token("carol", "crows")
    done = competitor.run("login", competitor.site.url, "--token", token, "--json")

    document = json.loads(done.stdout)
    assert document["account"]["team"]["name"] == "crows"
    assert document["account"]["quota"]["left_today"] == 3
    assert token not in done.stdout


def test_logging_out_revokes_the_token(competitor: Competitor) -> None:
    token = competitor.site.token("dave")
    competitor.run("login", competitor.site.url, "--token", token)

    assert json.loads(competitor.run("login", "--logout", "--json").stdout) == {
        "url": competitor.site.url,
        "revoked": True,
    }

    assert token not in kept().path.read_text()
    again = competitor.run("login", competitor.site.url, "--token", token)
    assert again.returncode == 1
    assert "this token is unknown or revoked" in again.stderr
    assert "you are logged in to no season" in competitor.run("team", "show").stderr


def test_an_invitation_is_needed_where_registration_is_not_open(
    competitor: Competitor, invited: Site
) -> None:
    register = ("login", invited.url, "--register", "--name", "erin")
    wrong = competitor.run(*register, "--invitation", "invite_wrong", stdin=PASSWORD)
    assert wrong.returncode == 1
    assert "this invitation is unknown, used up or expired" in wrong.stderr

    done = competitor.run(*register, "--invitation", invited.invitation(), stdin=f"{PASSWORD}\n")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("missing", ["--name", "--invitation"])
def test_standard_input_is_read_for_the_password_alone(
    competitor: Competitor, invited: Site, missing: str
) -> None:
    given = {"--name": "fred", "--invitation": "invite_key"}
    del given[missing]
    options = [word for option in given.items() for word in option]

    refused = competitor.run("login", invited.url, "--register", *options, stdin=f"{PASSWORD}\n")

    assert refused.returncode == 2
    assert refused.stderr == (
        f"wildscav: {missing} is missing: standard input is read for the password alone\n"
    )


def test_commands_are_about_the_season_logged_in_to_last_unless_one_is_named(
    competitor: Competitor, invited: Site, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = competitor.site, invited
    competitor.run("login", first.url, "--token", first.token("frank", "falcons"))
    competitor.run("login", second.url, "--token", second.token("frank", "finches"))

    def team(*options: str) -> str:
        return str(json.loads(competitor.run("team", "show", "--json", *options).stdout)["team"]["name"])

    assert team() == "finches"
    assert team("--season", first.url) == "falcons"
    monkeypatch.setenv("WILDSCAV_SEASON", first.url)
    assert team() == "falcons"
    monkeypatch.delenv("WILDSCAV_SEASON")
    # A login that is still valid needs no password again.
    assert competitor.run("login", first.url).returncode == 0
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
    done = competitor.run("login", competitor.site.url, *arguments)
    assert done.returncode == 2
    assert says in done.stderr
    assert not kept().path.exists()
