"""The tables of teams and their members."""

from datetime import datetime

from sqlalchemy import ForeignKey
from sqlalchemy.orm import Mapped, mapped_column

from wildscav_leaderboard.database.base import Base


class Team(Base):
    """Competitors who submit together and have one row on a board."""

    __tablename__ = "teams"

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    name: Mapped[str] = mapped_column(unique=True)  # 2 to 40 of a-z, 0-9 and -; part of addresses
    title: Mapped[str]  # as people read it, 1 to 60 printable characters
    created: Mapped[datetime]
    join_digest: Mapped[str | None] = mapped_column(default=None, unique=True)  # of the key for teammates
    disqualified: Mapped[str | None] = mapped_column(default=None)  # why; shown to everyone


class Member(Base):
    """An account's place in a team. An account is a member of one team at most."""

    __tablename__ = "members"

    account_id: Mapped[int] = mapped_column(ForeignKey("accounts.id"), primary_key=True)
    team_id: Mapped[int] = mapped_column(ForeignKey("teams.id"), index=True)
    joined: Mapped[datetime]
