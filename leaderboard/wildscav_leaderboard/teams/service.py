"""What can be done with teams: make one, join it with its key, leave it."""

from datetime import datetime

from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session

from wildscav_leaderboard.accounts.models import Account
from wildscav_leaderboard.accounts.passwords import TEAM_KEY, digest_of, new_key
from wildscav_leaderboard.database.connection import once
from wildscav_leaderboard.seasons.names import checked_line, checked_name, skeleton
from wildscav_leaderboard.seasons.refusals import ForbiddenError, NotFoundError, RefusalError
from wildscav_leaderboard.seasons.settings import SeasonSettings
from wildscav_leaderboard.teams.models import Member, Team


def make_team(session: Session, account: Account, name: str, title: str, now: datetime) -> tuple[Team, str]:
    """Make a team with one member, and return it with the key for teammates, which is shown once.

    Raises:
        RefusalError: The name is taken or not allowed, or the account is a member of another team.
    """
    checked_name(name, "name of the team")
    title = checked_line(title or name, "title of the team", 60)
    _check_free(session, account)
    if session.scalars(select(Team).filter_by(name=name)).first() is not None:
        raise RefusalError(f"there is already a team {name!r}: choose another name, or join it with its key")
    for other in session.scalars(select(Team.title)):
        if skeleton(other) == skeleton(title):
            raise RefusalError(f"the team {other!r} looks the same: choose another title")
    key = new_key(TEAM_KEY)
    team = Team(name=name, title=title, created=now, join_digest=digest_of(key))
    session.add(team)
    session.flush()
    session.add(Member(account_id=account.id, team_id=team.id, joined=now))
    session.flush()
    return team, key


def join_team(session: Session, settings: SeasonSettings, account: Account, key: str, now: datetime) -> Team:
    """Make an account a member of the team whose key it has.

    Raises:
        RefusalError: The key is unknown, the team is full, or the account is a member of another team.
    """
    _check_free(session, account)
    team = session.scalars(select(Team).filter_by(join_digest=digest_of(key))).one_or_none()
    if team is None:
        raise ForbiddenError("this key is of no team: ask a teammate for a new one")
    if len(members_of(session, team)) >= settings.quotas.members:
        raise RefusalError(f"the team {team.name} is full: it may have {settings.quotas.members} members")
    session.add(Member(account_id=account.id, team_id=team.id, joined=now))
    session.flush()
    return team


def _check_free(session: Session, account: Account) -> None:
    team = team_of(session, account)
    if team is not None:
        raise RefusalError(f"you are a member of the team {team.name}: leave it first")


def leave_team(session: Session, account: Account) -> None:
    """End an account's membership. What the team submitted stays.

    Raises:
        RefusalError: It is a member of none, or of one that is disqualified, and so are its members.
    """
    team = team_of(session, account)
    if team is None:
        raise RefusalError("you are a member of no team")
    if team.disqualified is not None:
        raise ForbiddenError(f"the team {team.name} is disqualified, and its members cannot leave it")
    session.execute(delete(Member).filter_by(account_id=account.id))


def new_team_key(team: Team) -> str:
    """Give a team another key for teammates, and return it; the old one is worth nothing from now on."""
    key = new_key(TEAM_KEY)
    team.join_digest = digest_of(key)
    return key


def team_of(session: Session, account: Account) -> Team | None:
    """Return the team of an account, if it has one."""
    wanted = select(Team).join(Member).where(Member.account_id == account.id)
    return once(session, (Member, account.id), lambda: session.scalars(wanted).one_or_none())


def own_team(session: Session, account: Account) -> Team:
    """Return the team of an account.

    Raises:
        ForbiddenError: It has none.
    """
    team = team_of(session, account)
    if team is None:
        raise ForbiddenError("you are a member of no team: make one, or join one with its key")
    return team


def find_team(session: Session, name: str) -> Team:
    """Return the team with a name.

    Raises:
        NotFoundError: There is none.
    """
    team = session.scalars(select(Team).filter_by(name=name)).one_or_none()
    if team is None:
        raise NotFoundError(f"there is no team {name!r}")
    return team


def members_of(session: Session, team: Team) -> list[str]:
    """Return the names of a team's members, in the order in which they joined."""
    wanted = select(Account.name).join(Member).where(Member.team_id == team.id)
    return list(session.scalars(wanted.order_by(Member.joined, Account.id)))


def count_teams(session: Session) -> int:
    """Return how many teams there are."""
    return session.scalar(select(func.count()).select_from(Team)) or 0


def titles(session: Session) -> dict[str, str]:
    """Return the titles of all teams by name, in their order."""
    found = session.scalars(select(Team).order_by(Team.title, Team.name))
    return {team.name: team.title for team in found}
