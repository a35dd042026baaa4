"""Where the records of matches are, and who may see them."""

from pathlib import Path

from sqlalchemy.orm import Session

from wildscav_leaderboard.accounts.service import Caller
from wildscav_leaderboard.matches.models import MatchResult
from wildscav_leaderboard.matches.service import find_match
from wildscav_leaderboard.matches.visibility import seen_by
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import ForbiddenError, NotFoundError


def record_path(session: Session, season: Season, number: int, caller: Caller | None) -> Path:
    """Return the path of a match's record, if the caller may see it.

    Raises:
        NotFoundError: There is no such match, or its record is gone.
        ForbiddenError: It is hidden.
    """
    why = seen_by(session, [find_match(session, number)], caller)[number].record
    if why:
        raise ForbiddenError(why)
    return path_of_record(session, season, number)


def path_of_record(session: Session, season: Season, number: int) -> Path:
    """Return the path of a match's record, whoever asks.

    Raises:
        NotFoundError: The match has no result, or its record is gone.
    """
    result = session.get(MatchResult, number)
    if result is None:
        raise NotFoundError(f"match {number} has no result")
    path = season.match_folder(number) / str(result.row["record"])
    if not path.is_file():
        raise NotFoundError(f"the record of match {number} is no longer in the season's files")
    return path
