"""How a season is doing: what waits, what is played, and what went wrong."""

from datetime import datetime, timedelta
from typing import Any

from pydantic import BaseModel, ConfigDict
from sqlalchemy import func, select
from sqlalchemy.orm import Session

from wildscav.errors import UserError
from wildscav_leaderboard.boards.progress import missing_entrants
from wildscav_leaderboard.conductor.attempts import running
from wildscav_leaderboard.conductor.editions import edition_changes, why_to_restart
from wildscav_leaderboard.conductor.lease import holder_of
from wildscav_leaderboard.conductor.models import Attempt
from wildscav_leaderboard.database.connection import clock
from wildscav_leaderboard.matches.models import Match
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.in_force import in_force
from wildscav_leaderboard.seasons.models import AuditEntry
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.teams.service import count_teams

FAULTS = 50  # the latest ones that are shown


class AttemptView(BaseModel):
    """An attempt at a piece of work."""

    model_config = ConfigDict(from_attributes=True)

    id: int
    kind: str
    number: int  # of this piece of work, from 1
    epoch: int  # of the conductor that began it
    submission_id: int | None
    match_id: int | None
    started: datetime
    begun: datetime | None  # a match is taken before its turn comes
    deadline: datetime
    ended: datetime | None
    outcome: str | None
    detail: str


class StatusView(BaseModel):
    """How a season is doing."""

    conductor: str | None  # who conducts; None if nobody does
    sandbox: str | None
    executor: str | None
    at_once: int | None  # matches
    phase: str  # not open yet, open, closed, being decided, or over
    frozen: bool  # whether the public boards stay as they are until the season is over
    paused: str | None  # why
    failed: str | None  # why nothing can be played
    teams: int
    submissions: dict[str, int]  # by state
    matches: dict[str, int]  # by state
    missing: dict[str, int]  # entrants without whom a ladder makes no matches, by track
    changes: list[str]  # of the rules, which are not in force yet
    attempts: list[AttemptView]  # that have not ended
    faults: list[AttemptView]  # of the platform, in the last day, the latest first


def status(session: Session, season: Season, now: datetime) -> StatusView:
    """Return how a season is doing."""
    written, wrong = _read_again(season)
    nodes = season_state.read_state(session, season_state.NODES) or {}
    paused = season_state.read_state(session, season_state.PAUSED)
    failed = season_state.read_state(session, season_state.FAILED)
    broken = select(Attempt).where(
        Attempt.outcome.in_(("platform", "lost")), Attempt.started > now - timedelta(days=1)
    )
    latest = broken.order_by(Attempt.id.desc()).limit(FAULTS)
    return StatusView(
        conductor=holder_of(session, clock(session)),
        sandbox=nodes.get("sandbox"),
        executor=nodes.get("executor"),
        at_once=nodes.get("at_once"),
        phase=_phase(session, season, now),
        frozen=season_state.is_frozen(session),
        paused=None if paused is None else str(paused["reason"]),
        failed=why_to_restart(session, written) if failed is None else str(failed["reason"]),
        teams=count_teams(session),
        submissions=count_by_state(session, Submission),
        matches=count_by_state(session, Match),
        missing=missing_entrants(session, in_force(session, season)),
        changes=[*wrong, *(one.text for one in edition_changes(session, written))],
        attempts=[AttemptView.model_validate(one) for one in running(session)],
        faults=[AttemptView.model_validate(one) for one in session.scalars(latest)],
    )


def _read_again(season: Season) -> tuple[Season, list[str]]:
    """Return a season as its files are now, since a server keeps the settings of its start.

    If they are wrong, it is as it was, with what is wrong.
    """
    try:
        return Season.open(season.folder), []
    except UserError as error:
        return season, [str(error)]


def _phase(session: Session, season: Season, now: datetime) -> str:
    if season_state.is_finalized(session):
        return "over"
    if season_state.read_state(session, season_state.FINALIZING) is not None:
        return "being decided"
    if now < season.settings.opens:
        return "not open yet"
    return "open" if now < season.settings.closes else "closed"


def nodes(session: Session) -> list[dict[str, Any]]:
    """Return the machines on which matches are played: name, cores, running, and problem, if there is one."""
    return list((season_state.read_state(session, season_state.NODES) or {}).get("nodes", []))


def audit_entries(session: Session, before: int | None, most: int) -> list[AuditEntry]:
    """Return privileged acts, the latest first."""
    wanted = select(AuditEntry).order_by(AuditEntry.id.desc()).limit(most)
    if before is not None:
        wanted = wanted.where(AuditEntry.id < before)
    return list(session.scalars(wanted))


def count_by_state(session: Session, table: type[Submission] | type[Match]) -> dict[str, int]:
    """Return how many rows of a table are in each state."""
    wanted = select(table.state, func.count()).group_by(table.state).order_by(table.state)
    return {state: count for state, count in session.execute(wanted)}  # noqa: C416 (rows are no pairs to mypy)
