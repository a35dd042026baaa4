"""Teams and accounts as they are shown."""

from collections import Counter
from datetime import datetime

from sqlalchemy import case, func, select
from sqlalchemy.orm import Session

from wildscav_leaderboard.accounts.models import Account
from wildscav_leaderboard.accounts.service import Caller
from wildscav_leaderboard.presentation.documents import AccountView, QuotaView, TeamRow, TeamView
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.quotas import active_of, day_after, used_today
from wildscav_leaderboard.teams.models import Member, Team
from wildscav_leaderboard.teams.service import members_of, team_of


def team_view(session: Session, team: Team) -> TeamView:
    """Return a team as it is shown to everyone."""
    return TeamView.about(team, members=members_of(session, team))


def team_rows(session: Session) -> list[TeamRow]:
    """Return all teams with what they handed in, by their titles."""
    members: dict[int, list[str]] = {}
    for team, name in session.execute(
        select(Member.team_id, Account.name)
        .join(Account, Account.id == Member.account_id)
        .order_by(Member.joined)
    ):
        members.setdefault(team, []).append(name)
    is_active = func.sum(case((Submission.state == states.ACTIVE, 1), else_=0))
    counted = select(Submission.team_id, func.count(), is_active).group_by(Submission.team_id)
    counts = {team: (count, active) for team, count, active in session.execute(counted)}
    return [
        TeamRow.about(
            team,
            members=members.get(team.id, []),
            submissions=counts.get(team.id, (0, 0))[0],
            active=counts.get(team.id, (0, 0))[1],
        )
        for team in session.scalars(select(Team).order_by(Team.title, Team.id))
    ]


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
