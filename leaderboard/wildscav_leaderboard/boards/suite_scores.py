"""What a conductor knows of the results of suites, so that it reads each of them once."""

from dataclasses import dataclass, field
from datetime import datetime

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from wildscav_leaderboard.matches.models import FINISHED, Match, MatchResult


@dataclass
class Scores:
    """The results under the same conditions."""

    metrics: dict[int, dict[int, dict[str, float]]] = field(default_factory=dict)  # by submission and match
    faults: dict[int, dict[int, bool]] = field(default_factory=dict)

    def faults_of(self, submission: int) -> int:
        """Return in how many matches of a submission something went wrong."""
        return sum(self.faults.get(submission, {}).values())


@dataclass
class _Suite:
    """The results of a track, by the digest of their conditions."""

    scores: dict[str, Scores] = field(default_factory=dict)
    seen: set[int] = field(default_factory=set)  # matches
    until: datetime | None = None  # when the last of them arrived


class SuiteScores:
    """The results of suites that were read so far."""

    def __init__(self) -> None:
        self._suites: dict[tuple[str, str], _Suite] = {}

    def read(self, session: Session, track: str, kind: str, conditions: str) -> Scores:
        """Return all results of a track, of which only those are read that arrived since the last time.

        Args:
            conditions: Digest of their conditions.
        """
        known = self._suites.setdefault((track, kind), _Suite())
        _read_new(session, track, kind, known)
        finished = (
            select(func.count())
            .select_from(Match)
            .filter_by(track=track, kind=kind, state=FINISHED, superseded=None)
        )
        # What was seen before was never stored, or other results have taken its place.
        if session.scalar(finished) != len(known.seen):
            known = self._suites[track, kind] = _Suite()
            _read_new(session, track, kind, known)
        return known.scores.get(conditions, Scores())


def _read_new(session: Session, track: str, kind: str, known: _Suite) -> None:
    """Read the results that arrived since the last one; results arrive in the order of their times."""
    columns = (MatchResult.at, MatchResult.conditions, MatchResult.row["metrics"], MatchResult.fault)
    wanted = (
        select(Match.id, Match.group_id, Match.number, *columns)
        .join(MatchResult, MatchResult.match_id == Match.id)
        .where(Match.track == track, Match.kind == kind, Match.superseded.is_(None))
    )
    if known.until is not None:
        wanted = wanted.where(MatchResult.at >= known.until)
    for match, submission, number, at, conditions, metrics, fault in session.execute(wanted):
        known.seen.add(match)
        known.until = at if known.until is None else max(known.until, at)
        scores = known.scores.setdefault(conditions, Scores())
        scores.metrics.setdefault(submission, {})[number] = metrics
        scores.faults.setdefault(submission, {})[number] = fault is not None
