"""Lists of matches."""

from sqlalchemy import select
from sqlalchemy.orm import Session, defer

from wildscav_leaderboard.matches.models import Match, MatchResult, MatchSeat

MOST = 100  # in one list


def list_matches(
    session: Session,
    *,
    submission: int | None = None,
    track: str | None = None,
    state: str | None = None,
    kind: str | None = None,
    before: int | None = None,
    limit: int = MOST,
) -> list[Match]:
    """Return matches, the newest first."""
    wanted = select(Match).order_by(Match.id.desc()).limit(limit).options(defer(Match.spec))  # it is large
    if submission is not None:
        own = select(MatchSeat.match_id).where(MatchSeat.submission_id == submission)
        wanted = wanted.where(Match.id.in_(own))
    for column, value in ((Match.track, track), (Match.state, state), (Match.kind, kind)):
        if value is not None:
            wanted = wanted.where(column == value)
    if before is not None:
        wanted = wanted.where(Match.id < before)
    return list(session.scalars(wanted))


def results_of(session: Session, matches: list[Match]) -> dict[int, MatchResult]:
    """Return the results of some matches, by match."""
    wanted = select(MatchResult).where(MatchResult.match_id.in_([match.id for match in matches]))
    return {result.match_id: result for result in session.scalars(wanted)}
