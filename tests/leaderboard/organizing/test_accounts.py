"""What organizers do with accounts: disable and enable them, give them new passwords. All acts are logged."""

import pytest
from sqlalchemy import select
from sqlalchemy.orm import Session
from tests.leaderboard.seasons_made import NOON

from wildscav_leaderboard.accounts.models import COMPETITOR, Account
from wildscav_leaderboard.accounts.passwords import hashed, matches, new_password
from wildscav_leaderboard.accounts.service import (
    add_account,
    caller_of_cookie,
    caller_of_token,
    new_token,
    open_web_session,
)
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.organizing import service
from wildscav_leaderboard.seasons.models import AuditEntry
from wildscav_leaderboard.seasons.refusals import (
    ForbiddenError,
    NotFoundError,
    RefusalError,
    UnknownCallerError,
)


def carl(session: Session) -> tuple[Account, str, str]:
    """Return an account with a token and a cookie."""
    account = add_account(session, "carl", hashed("the old password"), COMPETITOR, NOON)
    return account, new_token(session, account, "laptop", NOON), open_web_session(session, account, NOON)[0]


def acts(session: Session) -> list[tuple[str, str, str, str]]:
    entries = session.scalars(select(AuditEntry).order_by(AuditEntry.id))
    return [(one.actor, one.act, one.subject, one.detail) for one in entries]


def test_a_disabled_account_is_told_why_and_may_be_enabled_again(database: Database) -> None:
    with database.writing() as session:
        _, token, cookie = carl(session)
        service.disable_account(session, "anna", "carl", "a second account", NOON)

        with pytest.raises(ForbiddenError, match="disabled: a second account"):
            caller_of_token(session, token)
        assert caller_of_cookie(session, cookie, NOON) is None

        service.enable_account(session, "anna", "carl", NOON)
        assert caller_of_token(session, token)[0].account.name == "carl"
        assert acts(session) == [
            ("anna", "disable account", "account carl", "a second account"),
            ("anna", "enable account", "account carl", ""),
        ]


def test_a_new_password_ends_everything_that_began_with_the_old_one(database: Database) -> None:
    password = new_password()
    with database.writing() as session:
        account, token, cookie = carl(session)
        service.reset_password(session, "anna", "carl", hashed(password), NOON)

        assert matches(password, account.password)
        assert not matches("the old password", account.password)
        assert caller_of_cookie(session, cookie, NOON) is None
        with pytest.raises(UnknownCallerError):
            caller_of_token(session, token)
        assert acts(session) == [("anna", "reset password", "account carl", "")]


def test_what_cannot_be_done_with_an_account_is_refused(database: Database) -> None:
    with database.writing() as session:
        carl(session)
        with pytest.raises(NotFoundError, match="there is no account 'ben'"):
            service.disable_account(session, "anna", "ben", "nobody", NOON)
        with pytest.raises(RefusalError, match="your own account"):
            service.disable_account(session, "carl", "carl", "by mistake", NOON)
        with pytest.raises(RefusalError, match="is not disabled"):
            service.enable_account(session, "anna", "carl", NOON)
        with pytest.raises(NotFoundError):
            service.reset_password(session, "anna", "ben", "hash", NOON)
        assert acts(session) == []
