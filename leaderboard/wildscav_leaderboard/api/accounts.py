"""Accounts and tokens: what is shown of them, and the routes."""

from collections import Counter
from datetime import datetime

from fastapi import APIRouter
from sqlalchemy.orm import Session
from starlette.concurrency import run_in_threadpool

from wildscav_leaderboard.access.logins import log_in
from wildscav_leaderboard.access.rate_limits import SIGN_UPS
from wildscav_leaderboard.access.requests import (
    Address,
    Bearer,
    CurrentDatabase,
    CurrentSeason,
    KnownProgram,
    Limits,
    Now,
    Number,
    Reading,
)
from wildscav_leaderboard.accounts import passwords, service
from wildscav_leaderboard.accounts.service import Caller
from wildscav_leaderboard.api.documents import (
    AccountView,
    NewAccount,
    NewAccountView,
    NewToken,
    NewTokenView,
    QuotaView,
    TokenView,
)
from wildscav_leaderboard.api.teams import team_view
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.quotas import active_of, day_after, used_today
from wildscav_leaderboard.teams.models import Team
from wildscav_leaderboard.teams.service import team_of


def quota_view(session: Session, season: Season, team: Team, now: datetime) -> QuotaView:
    """Return what a team has used of its quota."""
    quotas, used = season.settings.quotas, used_today(session, Submission.team_id == team.id, now)
    return QuotaView(
        per_day=quotas.per_day,
        used_today=used,
        left_today=max(0, quotas.per_day - used),
        resets=day_after(now),
        active_per_track=quotas.active,
        active=Counter(track for one in active_of(session, team.id) for track in one.playing),
        archive=quotas.archive,
    )


def account_view(session: Session, season: Season, caller: Caller, now: datetime) -> AccountView:
    """Return whoever asks."""
    team = team_of(session, caller.account)
    return AccountView.about(
        caller.account,
        team=None if team is None else team_view(session, team),
        quota=None if team is None else quota_view(session, season, team, now),
    )


router = APIRouter(tags=["accounts"])


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
async def new_token(asked: NewToken, database: CurrentDatabase, now: Now, where: Address) -> NewTokenView:
    """Get a token with a name and a password."""
    account = await log_in(database, where, asked.name, asked.password)

    def made() -> NewTokenView:
        with database.writing() as session:
            return NewTokenView(token=service.new_token(session, account, asked.label, now))

    return await run_in_threadpool(made)


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
def revoke(token: Number, caller: KnownProgram, database: CurrentDatabase, now: Now) -> None:
    """Revoke one of your tokens."""
    with database.writing() as session:
        service.revoke_token(session, caller.account, token, now)


@router.get("/me")
def me(caller: KnownProgram, season: CurrentSeason, session: Reading, now: Now) -> AccountView:
    """Return your account, your team and its quota."""
    return account_view(session, season, caller, now)
