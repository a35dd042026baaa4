"""What organizers do with accounts: disable and enable them, give them new passwords. All acts are logged."""

from datetime import datetime, timedelta
from pathlib import Path

import pytest
from sqlalchemy import select
from sqlalchemy.orm import Session
from tests.leaderboard.seasons_made import NOON, make_season, team_with_member
from typer.testing import CliRunner

from wildscav_leaderboard.accounts.models import COMPETITOR, Account
from wildscav_leaderboard.accounts.passwords import hashed, matches, new_password
from wildscav_leaderboard.accounts.service import (
    add_account,
    caller_of_cookie,
    caller_of_token,
    new_token,
    open_web_session,
    register,
)
from wildscav_leaderboard.cli.season.app import app
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.organizing import acts
from wildscav_leaderboard.seasons.acts import Doing
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.models import AuditEntry
from wildscav_leaderboard.seasons.refusals import (
    ForbiddenError,
    NotFoundError,
    RefusalError,
    UnknownCallerError,
)


@pytest.fixture
def season(tmp_path: Path) -> Season:
    return make_season(tmp_path / "season")


def carl(session: Session) -> tuple[Account, str, str]:
    """Return an account with a token and a cookie."""
    account = add_account(session, "carl", hashed("the old password"), COMPETITOR, NOON)
    return account, new_token(session, account, "laptop", NOON), open_web_session(session, account, NOON)[0]


def logged(session: Session) -> list[tuple[str, str, str, str]]:
    entries = session.scalars(select(AuditEntry).order_by(AuditEntry.id))
    return [(one.actor, one.act, one.subject, one.detail) for one in entries]


def test_a_disabled_account_is_told_why_and_may_be_enabled_again(database: Database, season: Season) -> None:
    with database.writing() as session:
        _, token, cookie = carl(session)
        acts.disable_account(Doing(session, season, "anna", NOON), "carl", reason="a second account")

        with pytest.raises(ForbiddenError, match="disabled: a second account"):
            caller_of_token(session, token)
        assert caller_of_cookie(session, cookie, NOON) is None

        acts.enable_account(Doing(session, season, "anna", NOON), "carl")
        assert caller_of_token(session, token)[0].account.name == "carl"
        assert logged(session) == [
            ("anna", "disable account", "account carl", "a second account"),
            ("anna", "enable account", "account carl", ""),
        ]


def test_a_new_password_ends_everything_that_began_with_the_old_one(
    database: Database, season: Season
) -> None:
    password = new_password()
    with database.writing() as session:
        account, token, cookie = carl(session)
        acts.reset_password(Doing(session, season, "anna", NOON), "carl", password=password)

        assert matches(password, account.password)
        assert not matches("the old password", account.password)
        assert caller_of_cookie(session, cookie, NOON) is None
        with pytest.raises(UnknownCallerError):
            caller_of_token(session, token)
        assert logged(session) == [("anna", "reset password", "account carl", "")]


def test_what_cannot_be_done_with_an_account_is_refused(database: Database, season: Season) -> None:
    with database.writing() as session:
        carl(session)
        with pytest.raises(NotFoundError, match="there is no account 'ben'"):
            acts.disable_account(Doing(session, season, "anna", NOON), "ben", reason="nobody")
        with pytest.raises(RefusalError, match="your own account"):
            acts.disable_account(Doing(session, season, "carl", NOON), "carl", reason="by mistake")
        with pytest.raises(RefusalError, match="is not disabled"):
            acts.enable_account(Doing(session, season, "anna", NOON), "carl")
        with pytest.raises(NotFoundError):
            acts.reset_password(Doing(session, season, "anna", NOON), "ben")
        assert logged(session) == []


def test_a_command_does_the_act_that_its_argument_chooses_and_its_user_is_in_the_audit_log(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    season = make_season(tmp_path / "season")
    database = season.database()
    database.upgrade()
    with database.writing() as session:
        team_with_member(session, "foxes")
    monkeypatch.setattr("getpass.getuser", lambda: "ada")
    run, folder = CliRunner().invoke, str(season.folder)
    assert run(app, ["disqualify", folder, "foxes", "-r", "one person"]).output == "foxes is disqualified\n"
    key = run(app, ["invite", folder, "--organizer", "--label", "Ben", "--uses", "0"]).output.strip()
    assert key.startswith("invite_")
    missing = run(app, ["disqualify", folder, "7", "-r", "it cheats"])
    assert str(missing.exception) == "there is no submission 7"
    long = run(app, ["pause", folder, "--reason", "x" * 501])
    assert str(long.exception) == "the reason must have 1 to 500 printable characters on one line"
    with database.reading() as session:
        assert logged(session) == [
            ("command line (ada)", "disqualify team", "team foxes", "one person"),
            ("command line (ada)", "invite", "organizer", "Ben: any number of registrations"),
        ]
    database.close()


def test_an_invitation_expires_unless_its_organizer_wants_none_to(database: Database, season: Season) -> None:
    with database.writing() as session:
        keys = [
            acts.invite(Doing(session, season, "anna", NOON), uses=0, **given).key
            for given in ({}, {"days": 2}, {"days": 0})
        ]
        for days, valid in ((1, [True, True, True]), (3, [True, False, True]), (31, [False, False, True])):
            now = NOON + timedelta(days=days)
            assert [
                registers(session, season, key, f"ada-{days}-{number}", now)
                for number, key in enumerate(keys)
            ] == valid


def registers(session: Session, season: Season, key: str, name: str, now: datetime) -> bool:
    try:
        register(session, season.settings, name, "hash", key, now)
    except ForbiddenError:
        return False
    return True
