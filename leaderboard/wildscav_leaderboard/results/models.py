"""The tables: submissions, evaluations, their scores and matches, and tournaments."""

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, ForeignKey, UniqueConstraint
from sqlalchemy.orm import DeclarativeBase, Mapped, MappedAsDataclass, mapped_column, relationship

UNKNOWN = "unknown"  # sandbox of evaluations from before it was stored
# What an evaluation depends on besides its submission. Only evaluations with equal conditions can be
# compared.
CONDITIONS = (
    *("track", "suite", "seed"),
    *("engine_version", "simulation_version", "generator_version", "record_version"),
    *("sandbox", "limits"),
)
UNKNOWN_VERSION = 0  # of evaluations from before versions were stored


class Base(MappedAsDataclass, DeclarativeBase, kw_only=True):
    """Base of all tables."""


class Submission(Base):
    """An immutable, versioned, packaged agent. Different content is a different submission."""

    __tablename__ = "submissions"
    __table_args__ = (UniqueConstraint("name", "version", "digest"),)

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    name: Mapped[str] = mapped_column(index=True)
    version: Mapped[str]
    digest: Mapped[str]  # of the folder's content

    evaluations: Mapped[list["Evaluation"]] = relationship(
        back_populates="submission", cascade="all, delete-orphan", default_factory=list, repr=False
    )


class Evaluation(Base):
    """One submission on one suite of one track, in one sandbox. Evaluating it again replaces this."""

    __tablename__ = "evaluations"
    __table_args__ = (UniqueConstraint("submission_id", *CONDITIONS, name="one_result"),)

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    submission_id: Mapped[int] = mapped_column(ForeignKey("submissions.id"), init=False)
    submission: Mapped[Submission] = relationship(back_populates="evaluations")
    track: Mapped[str]
    suite: Mapped[str]
    seed: Mapped[str]  # decimal, since it may exceed any integer column; or the beginning of a commitment
    engine_version: Mapped[str]
    simulation_version: Mapped[int] = mapped_column(server_default=str(UNKNOWN_VERSION))
    generator_version: Mapped[int] = mapped_column(server_default=str(UNKNOWN_VERSION))
    record_version: Mapped[int] = mapped_column(server_default=str(UNKNOWN_VERSION))
    sandbox: Mapped[str] = mapped_column(server_default=UNKNOWN)  # in which agents ran
    limits: Mapped[str] = mapped_column(server_default="{}")  # that the sandbox enforced, as JSON
    started: Mapped[datetime]  # UTC
    faults: Mapped[int]  # matches in which something went wrong
    key: Mapped[str | None] = mapped_column(default=None)  # public key that its ledger is signed with

    scores: Mapped[list["Score"]] = relationship(
        cascade="all, delete-orphan", order_by="Score.position", default_factory=list, repr=False
    )
    matches: Mapped[list["MatchResult"]] = relationship(
        cascade="all, delete-orphan", order_by="MatchResult.index", default_factory=list, repr=False
    )


class Tournament(Base):
    """A tournament on one track. Playing it again replaces this."""

    __tablename__ = "tournaments"

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    # Digest of the entrants and everything else it depends on.
    identity: Mapped[str] = mapped_column(unique=True)
    track: Mapped[str] = mapped_column(index=True)
    suite: Mapped[str]
    started: Mapped[datetime]  # UTC
    key: Mapped[str | None]  # public key that its ledger is signed with
    document: Mapped[dict[str, Any]] = mapped_column(JSON)  # the tournament's file


class Score(Base):
    """One metric of an evaluation. The first decides the rank."""

    __tablename__ = "scores"

    evaluation_id: Mapped[int] = mapped_column(ForeignKey("evaluations.id"), primary_key=True, init=False)
    position: Mapped[int] = mapped_column(primary_key=True)  # 0 for the metric that decides the rank
    name: Mapped[str]
    title: Mapped[str]
    unit: Mapped[str]
    lower_is_better: Mapped[bool]
    mean: Mapped[float]
    std: Mapped[float | None]
    low: Mapped[float]  # of the 95 % interval
    high: Mapped[float]


class MatchResult(Base):
    """One match of an evaluation."""

    __tablename__ = "match_results"

    evaluation_id: Mapped[int] = mapped_column(ForeignKey("evaluations.id"), primary_key=True, init=False)
    index: Mapped[int] = mapped_column(primary_key=True)  # in the suite
    status: Mapped[str]
    fault: Mapped[str | None]
    detail: Mapped[str]
    metrics: Mapped[dict[str, Any] | None] = mapped_column(JSON)
