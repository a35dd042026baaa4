"""The tables of matches, their seats, and their results."""

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, ColumnElement, ForeignKey, Index, UniqueConstraint, and_, or_
from sqlalchemy.ext.hybrid import hybrid_property
from sqlalchemy.orm import Mapped, mapped_column

from wildscav_leaderboard.database.base import Base

SUITE, LADDER, FINAL = "suite", "ladder", "final"  # kinds of matches
# Groups of a ladder's matches: those of the season, and those that decide it.
SEASON_ROUND, FINAL_ROUND = 0, 1
WAITING, PLAYING, FINISHED, VOID = "waiting", "playing", "finished", "void"  # states of a match


class Match(Base):
    """One match. Its identifier grows with its creation, which is the order of the ladder."""

    __tablename__ = "matches"
    __table_args__ = (
        # A match is made once, however often the conductor tries.
        UniqueConstraint("kind", "track", "number", "group_id", "edition_id", "judging"),
        Index("ix_matches_state_priority", "state", "priority", "id"),
        Index("ix_matches_track_kind", "track", "kind", "id", "state"),
    )

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    kind: Mapped[str]
    track: Mapped[str]
    number: Mapped[int]  # in the suite, or of the ladder's matches on this track
    group_id: Mapped[int]  # in a suite: the submission; on a ladder: SEASON_ROUND or FINAL_ROUND
    spec: Mapped[dict[str, Any]] = mapped_column(JSON, repr=False)  # the MatchSpec; hidden until the end
    created: Mapped[datetime]
    since: Mapped[datetime]  # when it came into its state
    edition_id: Mapped[int | None] = mapped_column(ForeignKey("editions.id"), default=None)  # its rules
    judging: Mapped[int] = mapped_column(default=1)  # more than 1 where organizers had it played again
    superseded: Mapped[datetime | None] = mapped_column(default=None)  # when a later judging took its place
    state: Mapped[str] = mapped_column(default=WAITING)
    priority: Mapped[int] = mapped_column(default=0)  # less is played first
    deadline: Mapped[datetime | None] = mapped_column(default=None)  # while it is played
    platform_faults: Mapped[int] = mapped_column(default=0)  # attempts that the platform broke
    detail: Mapped[str] = mapped_column(default="")  # why it is void

    @hybrid_property
    def decides(self) -> bool:
        """Whether it is one of the matches that decide the season, drawn from the second secret."""
        return self.kind == FINAL or (self.kind == LADDER and self.group_id == FINAL_ROUND)

    @decides.inplace.expression
    @classmethod
    def _decides(cls) -> ColumnElement[bool]:
        return or_(cls.kind == FINAL, and_(cls.kind == LADDER, cls.group_id == FINAL_ROUND))


class MatchSeat(Base):
    """Who plays in a match: a submission, or a robot that is an entrant of the ladder."""

    __tablename__ = "match_seats"

    match_id: Mapped[int] = mapped_column(ForeignKey("matches.id"), primary_key=True)
    seat: Mapped[int] = mapped_column(primary_key=True)
    submission_id: Mapped[int | None] = mapped_column(ForeignKey("submissions.id"), index=True)
    entrant: Mapped[str]  # the submission's entrant, or robot:NAME


class MatchResult(Base):
    """The result of a match. There is one at most: the first to arrive stays."""

    __tablename__ = "match_results"
    __table_args__ = (Index("ix_match_results_at", "at"),)

    match_id: Mapped[int] = mapped_column(ForeignKey("matches.id"), primary_key=True)
    attempt_id: Mapped[int | None]  # that brought it
    at: Mapped[datetime]
    row: Mapped[dict[str, Any]] = mapped_column(JSON, repr=False)  # evaluator's MatchRow, all seats
    timing: Mapped[dict[str, Any]] = mapped_column(JSON, repr=False)  # evaluator's MatchTiming
    conditions: Mapped[str]  # digest of the conditions under which it was played
    record: Mapped[str]  # BLAKE2b digest of the record's file, 32 hexadecimal digits
    record_size: Mapped[int]  # bytes
    # Cut out of ``row``, so that boards and pages need not read it.
    fault: Mapped[str | None]  # of the first seat in which something went wrong
    score: Mapped[float | None]  # in a suite: the submission's score in this match
