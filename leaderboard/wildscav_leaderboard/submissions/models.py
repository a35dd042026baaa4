"""The tables of submissions and of the history of their states."""

from datetime import datetime

from sqlalchemy import ForeignKey, Index, String
from sqlalchemy.orm import Mapped, mapped_column

from wildscav_evaluator.output.results import OtherInterface
from wildscav_leaderboard.database.base import Base


class Submission(Base):
    """An immutable, versioned, packaged agent of a team. Its states are described in ``states.py``."""

    __tablename__ = "submissions"
    __table_args__ = (Index("ix_submissions_state_id", "state", "id"),)

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    team_id: Mapped[int] = mapped_column(ForeignKey("teams.id"), index=True)
    account_id: Mapped[int] = mapped_column(ForeignKey("accounts.id"))  # who submitted it
    name: Mapped[str]  # of its manifest
    version: Mapped[str]
    message: Mapped[str]  # of the competitor, one line
    tracks: Mapped[list[str]]  # of the season that its manifest names
    digest: Mapped[str]  # of the folder's content, 32 hexadecimal digits
    content: Mapped[str]  # digest of what plays, without labels; empty for older submissions
    archive: Mapped[str]  # name of its file in the season's files: its SHA-256 and suffix
    size: Mapped[int]  # bytes of the archive
    created: Mapped[datetime] = mapped_column(index=True)
    state: Mapped[str]
    since: Mapped[datetime]  # when it came into this state
    deadline: Mapped[datetime | None] = mapped_column(default=None)  # for leaving it
    # Two counters: attempts that the platform broke are retried and never charged to the team's quota.
    platform_faults: Mapped[int] = mapped_column(default=0)
    charged: Mapped[bool] = mapped_column(default=True)  # whether it counts for the quota of its day
    # Why it failed or was disabled.
    fault: Mapped[str | None] = mapped_column(default=None)  # "agent" or "platform"
    reason: Mapped[str] = mapped_column(default="")  # what happened, in one line
    playing: Mapped[list[str]] = mapped_column(default_factory=list)  # tracks on which it takes part
    kept: Mapped[bool] = mapped_column(default=False)  # whether no later one replaces it unasked
    replaces: Mapped[int | None] = mapped_column(default=None)  # which one its team wants it to replace
    last_lines: Mapped[list[str]] = mapped_column(default_factory=list)  # that its agent printed
    command: Mapped[str] = mapped_column(default="")  # that shows it again on the competitor's machine
    interface: Mapped[OtherInterface | None] = mapped_column(
        String, default=None
    )  # by which it plays; None for numbers

    @property
    def entrant(self) -> str:
        """Its name in matches and records, which no other submission of the season has."""
        return entrant_of(self.name, self.id)


def entrant_of(name: str, number: int) -> str:
    """Return the name of a submission in matches and records, which no other one of the season has."""
    return f"{name[:28]}-{number}"


class Transition(Base):
    """A submission's step from one state to the next."""

    __tablename__ = "transitions"

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    submission_id: Mapped[int] = mapped_column(ForeignKey("submissions.id"), index=True)
    at: Mapped[datetime]
    state: Mapped[str]  # the new one
    detail: Mapped[str] = mapped_column(default="")
