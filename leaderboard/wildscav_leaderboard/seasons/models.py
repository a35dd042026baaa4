"""The tables of the season itself: its state and editions, announcements, and the log of privileged acts."""

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from wildscav_leaderboard.database.base import Base


class StateValue(Base):
    """One fact about the season that changes while it runs, by its name (``seasons/state.py``)."""

    __tablename__ = "season_state"

    name: Mapped[str] = mapped_column(primary_key=True)
    value: Mapped[dict[str, Any]]
    updated: Mapped[datetime]


class EditionRow(Base):
    """An edition as it is stored. Rows are only added."""

    __tablename__ = "editions"
    __table_args__ = (UniqueConstraint("track", "digest"),)

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    track: Mapped[str]
    digest: Mapped[str]  # of its conditions
    created: Mapped[datetime]
    # An ``Edition`` (``seasons/editions.py``).
    document: Mapped[dict[str, Any]] = mapped_column(JSON, repr=False)


class Announcement(Base):
    """A text that the organizers show to everyone."""

    __tablename__ = "announcements"

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    at: Mapped[datetime]
    author: Mapped[str]  # name of the account
    title: Mapped[str]
    text: Mapped[str]


class AuditEntry(Base):
    """One privileged act. Entries are only added."""

    __tablename__ = "audit_log"

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    at: Mapped[datetime] = mapped_column(index=True)
    actor: Mapped[str]  # name of the account, or "command line (USER)", or "the conductor"
    act: Mapped[str]  # a verb, such as "disqualify team"
    subject: Mapped[str]  # what it was done to, such as "team foxes"
    detail: Mapped[str] = mapped_column(default="")  # the reason, or what changed
