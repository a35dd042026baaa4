"""Routes of accounts and tokens."""

from typing import Annotated

from fastapi import APIRouter, Depends, Request

from wildscav_leaderboard.access.rate_limits import SIGN_UPS, TRIES, RateLimits
from wildscav_leaderboard.access.requests import (
    Bearer,
    CurrentDatabase,
    CurrentSeason,
    KnownProgram,
    Now,
    Reading,
    address_of,
)
from wildscav_leaderboard.accounts import passwords, service
from wildscav_leaderboard.presentation.documents import (
    AccountView,
    NewAccount,
    NewAccountView,
    NewToken,
    NewTokenView,
    TokenView,
)
from wildscav_leaderboard.presentation.people import account_view

router = APIRouter(tags=["accounts"])


def rate_limits(request: Request) -> RateLimits:
    """Return the counters of this process."""
    limits: RateLimits = request.app.state.limits
    return limits


Limits = Annotated[RateLimits, Depends(rate_limits)]
Address = Annotated[str, Depends(address_of)]


@router.post("/accounts", status_code=201)
def register(
    new: NewAccount,
    season: CurrentSeason,
    database: CurrentDatabase,
    now: Now,
    limits: Limits,
    where: Address,
) -> NewAccountView:
    """Register, and get a first token."""
    limits.use(SIGN_UPS, "accounts", where)
    hashed = passwords.hashed(new.password)
    with database.writing() as session:
        account = service.register(session, season.settings, new.name, hashed, new.invitation, now)
        token = service.new_token(session, account, "registration", now)
        return NewAccountView(name=account.name, role=account.role, token=token)


@router.post("/tokens", status_code=201)
def new_token(
    asked: NewToken, database: CurrentDatabase, now: Now, limits: Limits, where: Address
) -> NewTokenView:
    """Get a token with a name and a password."""
    limits.use(TRIES, "address", where)
    limits.use(TRIES, "name", asked.name)
    account = service.checked_account(database, asked.name, asked.password)
    with database.writing() as session:
        return NewTokenView(token=service.new_token(session, account, asked.label, now))


@router.get("/tokens")
def tokens(caller: KnownProgram, session: Reading) -> list[TokenView]:
    """List your tokens."""
    return [TokenView.model_validate(one) for one in service.tokens_of(session, caller.account)]


@router.delete("/tokens/current", status_code=204)
def revoke_current(_caller: KnownProgram, given: Bearer, database: CurrentDatabase, now: Now) -> None:
    """Revoke the token that the request shows."""
    if given is not None:
        with database.writing() as session:
            service.revoke_this_token(session, given.credentials, now)


@router.delete("/tokens/{token}", status_code=204)
def revoke(token: int, caller: KnownProgram, database: CurrentDatabase, now: Now) -> None:
    """Revoke one of your tokens."""
    with database.writing() as session:
        service.revoke_token(session, caller.account, token, now)


@router.get("/me")
def me(caller: KnownProgram, season: CurrentSeason, session: Reading, now: Now) -> AccountView:
    """Return your account, your team and its quota."""
    return account_view(session, season, caller, now)
