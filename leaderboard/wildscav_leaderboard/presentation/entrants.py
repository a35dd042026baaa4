"""Entrants of matches as people read them: a submission with its version and its team, or a robot."""

from collections.abc import Collection
from typing import NamedTuple

from sqlalchemy import select
from sqlalchemy.orm import Session

from wildscav_evaluator.seats import ROBOT_ENTRANT
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.teams.models import Team


class EntrantNames(NamedTuple):
    """What people read of a submission that plays."""

    name: str  # its name and version
    team: str
    team_title: str


def entrant_names(session: Session, submissions: Collection[int]) -> dict[int, EntrantNames]:
    """Return what people read of some submissions, by number."""
    wanted = (
        select(Submission.id, Submission.name, Submission.version, Team.name, Team.title)
        .join(Team, Team.id == Submission.team_id)
        .where(Submission.id.in_(submissions))
    )
    return {
        number: EntrantNames(titled(name, version), team, title)
        for number, name, version, team, title in session.execute(wanted)
    }


def titled(name: str, version: str) -> str:
    """Return a submission's name and version as people read them."""
    return f"{name} {version}"


def robot_name(entrant: str) -> str:
    """Return a robot's name as people read it."""
    return entrant.removeprefix(ROBOT_ENTRANT)
