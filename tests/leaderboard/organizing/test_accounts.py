"""Accounts: whose tokens and browsers are, until when, and what organizers do. All acts are logged."""

from datetime import datetime, timedelta
from pathlib import Path

import pytest
from sqlalchemy import select
from sqlalchemy.orm import Session
from tests.leaderboard.seasons_made import NOON, make_account, make_season, opened, team_with_member
from typer.testing import CliRunner

from wildscav_leaderboard.accounts.models import COMPETITOR, Account
from wildscav_leaderboard.accounts.passwords import hashed, matches, new_password
from wildscav_leaderboard.accounts.service import (
    MAX_TOKENS,
    SESSION_LASTS,
    add_account,
    caller_of_cookie,
    caller_of_token,
    close_web_session,
    new_token,
    open_web_session,
    register,
    revoke_token,
    tokens_of,
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
        anna, own = (Doing(session, season, name, NOON) for name in ("anna", "carl"))
        with pytest.raises(NotFoundError, match="there is no account 'ben'"):
            acts.disable_account(anna, "ben", reason="nobody")
        with pytest.raises(RefusalError, match="your own account"):
            acts.disable_account(own, "carl", reason="by mistake")
        with pytest.raises(RefusalError, match="is not disabled"):
            acts.enable_account(anna, "carl")
        with pytest.raises(NotFoundError, match="there is no account 'ben'"):
            acts.reset_password(anna, "ben")
        assert logged(session) == []


def test_a_command_does_the_act_that_its_argument_chooses_and_its_user_is_in_the_audit_log(
    season: Season, monkeypatch: pytest.MonkeyPatch
) -> None:
    with opened(season) as database:
        with database.writing() as session:
            team_with_member(session, "foxes")
        monkeypatch.setattr("getpass.getuser", lambda: "ada")
        run, folder = CliRunner().invoke, str(season.folder)
        assert (
            run(app, ["disqualify", folder, "foxes", "-r", "one person"]).output == "foxes is disqualified\n"
        )
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


def test_an_invitation_expires_unless_its_organizer_wants_none_to(database: Database, season: Season) -> None:
    with database.writing() as session:
        keys = [
            acts.invite(Doing(session, season, "anna", NOON), uses=0, **given).key
            for given in ({}, {"days": 2}, {"days": 0})
        ]
        for days, valid in ((1, [True, True, True]), (3, [True, False, True]), (31, [False, False, True])):
            now = NOON + timedelta(days=days)
            made = (registers(session, season, key, f"ada-{days}-{one}", now) for one, key in enumerate(keys))
            assert list(made) == valid


def registers(session: Session, season: Season, key: str, name: str, now: datetime) -> bool:
    try:
        register(session, season.settings, name, "hash", key, now)
    except ForbiddenError:
        return False
    return True


def test_a_token_is_its_owners_until_its_owner_revokes_it(database: Database) -> None:
    with database.writing() as session:
        ada, eve = make_account(session, "ada"), make_account(session, "eve")
        token = new_token(session, ada, "laptop", NOON)
        caller, found = caller_of_token(session, token)
        assert caller.account is ada
        with pytest.raises(NotFoundError, match=f"you have no token {found.id}"):
            revoke_token(session, eve, found.id, NOON)
        revoke_token(session, ada, found.id, NOON)
        with pytest.raises(NotFoundError):
            revoke_token(session, ada, found.id, NOON)
        for unknown in (token, "", token[:-1]):
            with pytest.raises(UnknownCallerError, match="unknown or revoked"):
                caller_of_token(session, unknown)


def test_an_account_has_so_many_tokens_and_a_revoked_one_makes_room(database: Database) -> None:
    with database.writing() as session:
        ada = make_account(session, "ada")
        for number in range(MAX_TOKENS):
            new_token(session, ada, f"machine {number}", NOON)
        with pytest.raises(RefusalError, match=f"at most {MAX_TOKENS} tokens"):
            new_token(session, ada, "one more", NOON)
        revoke_token(session, ada, tokens_of(session, ada)[0].id, NOON)
        new_token(session, ada, "one more", NOON)
        assert tokens_of(session, ada)[-1].label == "one more"


def test_a_browser_is_logged_in_until_it_logs_out_or_its_time_is_over(database: Database) -> None:
    with database.writing() as session:
        ada = make_account(session, "ada")
        (cookie, csrf), (other, _) = (open_web_session(session, ada, NOON) for _ in range(2))
        caller = caller_of_cookie(session, cookie, NOON)
        assert caller is not None
        assert (caller.account, caller.csrf) == (ada, csrf)
        assert caller_of_cookie(session, cookie, NOON + SESSION_LASTS) is None
        close_web_session(session, cookie)
        assert caller_of_cookie(session, cookie, NOON) is None
        assert caller_of_cookie(session, other, NOON) is not None
