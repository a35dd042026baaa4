"""How far a demo season is: its submissions are validated first, and then their matches are played."""

from dataclasses import dataclass

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import FINISHED, PLAYING, WAITING, Match
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission


@dataclass(frozen=True)
class Opening:
    """How far the season is."""

    submissions: int
    validated: int  # that take part, or failed
    played: int  # matches
    ahead: int  # matches that wait or are being played

    def is_ready(self, matches: int) -> bool:
        """Return whether so many matches are played, or as many as there are."""
        return self.validated == self.submissions and (self.played >= matches or not self.ahead)


def opening_of(database: Database) -> Opening:
    """Return how far a season is."""
    with database.reading() as session:
        counted = _counts(session, Submission)
        played = _counts(session, Match)
    over = sum(counted.get(state, 0) for state in (states.ACTIVE, *states.FINAL))
    ahead = sum(played.get(state, 0) for state in (WAITING, PLAYING))
    return Opening(sum(counted.values()), over, played.get(FINISHED, 0), ahead)


def _counts(session: Session, table: type[Submission] | type[Match]) -> dict[str, int]:
    """Return how many rows of a table are in each state."""
    rows = session.execute(select(table.state, func.count()).group_by(table.state))
    return {state: count for state, count in rows}  # noqa: C416 (rows are no pairs to mypy)
