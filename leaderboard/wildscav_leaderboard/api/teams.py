"""Teams and their webhooks: how they are shown, and the routes."""

from fastapi import APIRouter
from sqlalchemy import case, func, select
from sqlalchemy.orm import Session

from wildscav_leaderboard.access.requests import (
    CurrentDatabase,
    CurrentSeason,
    KnownProgram,
    Now,
    Number,
    Reading,
)
from wildscav_leaderboard.accounts.models import Account
from wildscav_leaderboard.api.documents import (
    Key,
    KeyView,
    NewTeam,
    NewTeamView,
    NewWebhook,
    NewWebhookView,
    TeamRow,
    TeamView,
    WebhookView,
)
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.teams import service
from wildscav_leaderboard.teams.models import Member, Team
from wildscav_leaderboard.webhooks import service as webhooks


def team_view(session: Session, team: Team) -> TeamView:
    """Return a team as it is shown to everyone."""
    return TeamView.about(team, members=service.members_of(session, team))


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


router = APIRouter(tags=["teams"])


@router.get("/teams")
def teams(session: Reading) -> list[TeamRow]:
    """List all teams, by their titles."""
    return team_rows(session)


@router.post("/teams", status_code=201)
def make(new: NewTeam, caller: KnownProgram, database: CurrentDatabase, now: Now) -> NewTeamView:
    """Make a team, and get the key with which others join it."""
    with database.writing() as session:
        team, key = service.make_team(session, caller.account, new.name, new.title, now)
        return NewTeamView(team=team_view(session, team), key=key)


@router.post("/teams/join")
def join(
    given: Key, caller: KnownProgram, season: CurrentSeason, database: CurrentDatabase, now: Now
) -> TeamView:
    """Join a team with its key."""
    with database.writing() as session:
        team = service.join_team(session, season.settings, caller.account, given.key, now)
        return team_view(session, team)


@router.post("/teams/leave", status_code=204)
def leave(caller: KnownProgram, database: CurrentDatabase) -> None:
    """Leave your team. What it submitted stays."""
    with database.writing() as session:
        service.leave_team(session, caller.account)


@router.post("/teams/mine/key")
def new_key(caller: KnownProgram, database: CurrentDatabase) -> KeyView:
    """Get another key for teammates; the old one is worth nothing from now on."""
    with database.writing() as session:
        return KeyView(key=service.new_team_key(service.own_team(session, caller.account)))


@router.get("/teams/{name}")
def team(name: str, session: Reading) -> TeamView:
    """Return a team."""
    return team_view(session, service.find_team(session, name))


@router.get("/webhooks")
def list_webhooks(caller: KnownProgram, session: Reading) -> list[WebhookView]:
    """List your team's webhooks."""
    own = service.own_team(session, caller.account)
    return [WebhookView.model_validate(one) for one in webhooks.webhooks_of(session, own)]


@router.post("/webhooks", status_code=201)
def add_webhook(new: NewWebhook, caller: KnownProgram, database: CurrentDatabase, now: Now) -> NewWebhookView:
    """Register an address that gets messages when the state of a submission changes."""
    with database.writing() as session:
        own = service.own_team(session, caller.account)
        added = webhooks.add_webhook(session, own, new.url, now)
        return NewWebhookView(webhook=WebhookView.model_validate(added), secret=added.secret)


@router.delete("/webhooks/{webhook}", status_code=204)
def remove_webhook(webhook: Number, caller: KnownProgram, database: CurrentDatabase) -> None:
    """Remove one of your team's webhooks."""
    with database.writing() as session:
        webhooks.remove_webhook(session, service.own_team(session, caller.account), webhook)


@router.post("/webhooks/{webhook}/test", status_code=202)
def test_webhook(webhook: Number, caller: KnownProgram, database: CurrentDatabase, now: Now) -> WebhookView:
    """Send a message to one of your team's webhooks."""
    with database.writing() as session:
        own = service.own_team(session, caller.account)
        found = webhooks.own_webhook(session, own, webhook)
        webhooks.queue_for(session, found, "webhook.test", {"team": own.name}, now)
        return WebhookView.model_validate(found)
