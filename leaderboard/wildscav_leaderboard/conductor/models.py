"""The tables of the conductor: its lease, and attempts at work."""

from datetime import datetime

from sqlalchemy import ForeignKey, Index
from sqlalchemy.orm import Mapped, mapped_column

from wildscav_leaderboard.database.base import Base

BUILD, VALIDATE, PLAY = "build", "validate", "play"  # kinds of work


class Lease(Base):
    """Who is the conductor until when. Only its holder moves work on, in transactions that check it."""

    __tablename__ = "leases"

    name: Mapped[str] = mapped_column(primary_key=True)
    holder: Mapped[str]  # host, process and a random part
    epoch: Mapped[int]  # rises with every new holder
    until: Mapped[datetime]


class Attempt(Base):
    """One attempt at a piece of work. It is kept apart from the result, which only one attempt can bring."""

    __tablename__ = "attempts"
    __table_args__ = (Index("ix_attempts_ended", "ended"),)  # those that have not ended are few

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    kind: Mapped[str]
    number: Mapped[int]  # of this piece of work, from 1
    epoch: Mapped[int]  # of the conductor that began it
    started: Mapped[datetime]
    deadline: Mapped[datetime]
    submission_id: Mapped[int | None] = mapped_column(ForeignKey("submissions.id"), default=None, index=True)
    match_id: Mapped[int | None] = mapped_column(ForeignKey("matches.id"), default=None, index=True)
    ended: Mapped[datetime | None] = mapped_column(default=None)
    begun: Mapped[datetime | None] = mapped_column(default=None)  # a match is taken before its turn comes
    # "done"; "agent" or "platform", whose fault it is that it broke; "lost", "returned" or "forgiven".
    outcome: Mapped[str | None] = mapped_column(default=None)
    detail: Mapped[str] = mapped_column(default="")
