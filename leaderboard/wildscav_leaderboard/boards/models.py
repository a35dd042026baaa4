"""The tables of boards: their current documents, the history of ranks, and the places on ladders."""

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, ForeignKey, Index
from sqlalchemy.orm import Mapped, mapped_column

from wildscav_leaderboard.database.base import Base


class Board(Base):
    """The current board of a track, as a document that pages, API and audit share (``documents.py``)."""

    __tablename__ = "boards"

    track: Mapped[str] = mapped_column(primary_key=True)
    audience: Mapped[str] = mapped_column(primary_key=True)
    updated: Mapped[datetime]
    document: Mapped[dict[str, Any]] = mapped_column(JSON, repr=False)


class BoardPoint(Base):
    """A point of the history of a submission's rank; one is added whenever its place changes."""

    __tablename__ = "board_points"
    __table_args__ = (Index("ix_board_points_track_submission", "track", "submission_id", "at"),)

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    track: Mapped[str]
    submission_id: Mapped[int] = mapped_column(ForeignKey("submissions.id"))
    at: Mapped[datetime]
    rank: Mapped[int]  # the best that it may have
    last_rank: Mapped[int]  # the worst that it may have
    score: Mapped[float]  # mean score, or rating
    low: Mapped[float]
    high: Mapped[float]
    matches: Mapped[int]


class LadderStep(Base):
    """An entrant's place in a match of a ladder. Results under other conditions are another ladder."""

    __tablename__ = "ladder_steps"
    __table_args__ = (Index("ix_ladder_steps_track_entrant", "track", "conditions", "entrant", "match_id"),)

    match_id: Mapped[int] = mapped_column(ForeignKey("matches.id"), primary_key=True)
    entrant: Mapped[str] = mapped_column(primary_key=True)
    track: Mapped[str]
    conditions: Mapped[str]  # digest of the conditions under which the match was played
    place: Mapped[int]  # of its team in the match, 1 is the best
    fault: Mapped[bool]  # whether something went wrong in its seat
