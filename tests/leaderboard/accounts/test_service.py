"""Tokens and browsers that are logged in: whose they are, and until when."""

import pytest
from tests.leaderboard.seasons_made import NOON, make_account

from wildscav_leaderboard.accounts.service import (
    MAX_TOKENS,
    SESSION_LASTS,
    caller_of_cookie,
    caller_of_token,
    close_web_session,
    new_token,
    open_web_session,
    revoke_token,
    tokens_of,
)
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.refusals import NotFoundError, RefusalError, UnknownCallerError


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
        assert [one.label for one in tokens_of(session, ada)][-2:] == [
            f"machine {MAX_TOKENS - 1}",
            "one more",
        ]


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
