"""Boards that were read: each is parsed once, and kept by the database until it changes."""

from dataclasses import dataclass
from datetime import datetime
from functools import cached_property

from pydantic import TypeAdapter
from sqlalchemy import select
from sqlalchemy.orm import Session

from wildscav_leaderboard.boards.documents import BoardDocument
from wildscav_leaderboard.boards.models import Board
from wildscav_leaderboard.database.connection import KEPT, once
from wildscav_leaderboard.visibility import PUBLIC, edition_of_audience

DOCUMENT: TypeAdapter[BoardDocument] = TypeAdapter(BoardDocument)


@dataclass(frozen=True)
class KeptBoard:
    """A board as it was at some time."""

    document: BoardDocument
    updated: datetime  # when it was stored; no other board of its track and audience was stored then

    @cached_property
    def json(self) -> bytes:
        """The board as JSON."""
        return DOCUMENT.dump_json(self.document)


def board_updated(session: Session, track: str, audience: str = PUBLIC) -> datetime | None:
    """Return when the board of a track changed last; None if there are no results yet."""
    return once(session, Board, lambda: _times(session)).get((track, audience))


def earlier_editions(session: Session, track: str) -> list[int]:
    """Return the editions of a track that are no longer in force and have a board, the latest first."""
    found = (
        edition_of_audience(name)
        for one, name in once(session, Board, lambda: _times(session))
        if one == track
    )
    return sorted((number for number in found if number is not None), reverse=True)


def _times(session: Session) -> dict[tuple[str, str], datetime]:
    """Return when each board changed last, by track and audience."""
    found = session.execute(select(Board.track, Board.audience, Board.updated))
    return {(track, audience): updated for track, audience, updated in found}


def kept_board(session: Session, track: str, audience: str = PUBLIC) -> KeptBoard | None:
    """Return the board of a track; None if there are no results yet."""
    updated = board_updated(session, track, audience)
    if updated is None:
        return None
    kept = session.info.get(KEPT, {})  # a session that writes keeps nothing: it may be undone
    found: KeptBoard | None = kept.get((Board, track, audience))
    if found is None or found.updated != updated:
        document = session.scalars(select(Board.document).filter_by(track=track, audience=audience)).one()
        found = kept[Board, track, audience] = KeptBoard(DOCUMENT.validate_python(document), updated)
    return found


def read_board(session: Session, track: str, audience: str = PUBLIC) -> BoardDocument | None:
    """Return the board of a track; None if there are no results yet."""
    found = kept_board(session, track, audience)
    return None if found is None else found.document
