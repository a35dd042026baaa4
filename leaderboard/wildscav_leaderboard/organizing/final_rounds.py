"""The final rounds of ladders: everyone who may be among the best plays anew, on games of the second secret.

A final round is a ladder with the same rules, and decides alone. Whoever was lucky in the season, or tried
many submissions until one was, is as likely to lead it as an equal. A ladder on which nobody can meet is
decided by its matches of the season.
"""

from collections.abc import Mapping

from sqlalchemy import select
from sqlalchemy.orm import Session

from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.boards.models import HIDDEN
from wildscav_leaderboard.matches.models import FINISHED, Match
from wildscav_leaderboard.seasons.folder import Season


def fields_of(session: Session, season: Season, best: int) -> dict[str, list[int]]:
    """Return who plays the final round of each ladder: whose intervals reach the first ``best`` places."""
    found = {}
    for track, settings in season.settings.tracks.items():
        board = read_board(session, track, HIDDEN) if settings.mode == "ladder" else None
        ranked = [] if board is None else [(row.submission, row.rank) for row in board.rows]
        field = [one for one, rank in ranked if one is not None and rank is not None and rank <= best]
        if len(field) > 1:
            found[track] = field
    return found


def decided_by(session: Session, season: Season, field: Mapping[str, list[int]]) -> dict[str, list[int]]:
    """Return the field of each track that matches of the second secret decide."""
    wanted = select(Match.track).where(Match.decides, Match.state == FINISHED).distinct()
    played = set(session.scalars(wanted))
    modes = {track: settings.mode for track, settings in season.settings.tracks.items()}
    return {track: one for track, one in field.items() if modes[track] == "suite" or track in played}
