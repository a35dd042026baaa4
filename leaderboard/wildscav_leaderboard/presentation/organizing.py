"""How a season is doing, as organizers see it."""

from datetime import datetime

from sqlalchemy import select
from sqlalchemy.orm import Session

from wildscav_leaderboard.accounts.models import Account
from wildscav_leaderboard.presentation.documents import View
from wildscav_leaderboard.teams.models import Member, Team


class AttemptView(View):
    """An attempt at a piece of work."""

    id: int
    kind: str
    number: int  # of this piece of work, from 1
    submission_id: int | None
    match_id: int | None
    started: datetime
    deadline: datetime
    ended: datetime | None
    outcome: str | None
    detail: str


class StatusView(View):
    """How the season is doing."""

    conductor: str | None  # who conducts; None if nobody does
    sandbox: str | None
    executor: str | None
    at_once: int | None  # matches
    paused: str | None  # why
    failed: str | None  # why nothing can be played
    teams: int
    submissions: dict[str, int]  # by state
    matches: dict[str, int]  # by state
    missing: dict[str, int]  # entrants without whom a ladder makes no matches, by track
    changes: list[str]  # of the rules, which are not in force yet
    attempts: list[AttemptView]  # that have not ended
    faults: list[AttemptView]  # of the platform, in the last day, the latest first


class AccountRow(View):
    """An account, as organizers see it."""

    name: str
    role: str
    team: str | None
    created: datetime
    disabled: str | None  # why it may not be used


def account_rows(session: Session) -> list[AccountRow]:
    """Return all accounts, by their names."""
    wanted = (
        select(Account, Team.name)
        .outerjoin(Member, Member.account_id == Account.id)
        .outerjoin(Team, Team.id == Member.team_id)
        .order_by(Account.name)
    )
    return [AccountRow.about(one, team=team) for one, team in session.execute(wanted)]
