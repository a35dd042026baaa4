"""The tables of webhooks and of the messages that are sent to them."""

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, ForeignKey, Index
from sqlalchemy.orm import Mapped, mapped_column

from wildscav_leaderboard.database.base import Base


class Webhook(Base):
    """An address of a team that gets messages."""

    __tablename__ = "webhooks"

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    team_id: Mapped[int] = mapped_column(ForeignKey("teams.id"), index=True)
    url: Mapped[str]
    secret: Mapped[str]  # that signs its messages, as standard-webhooks writes it: whsec_…
    created: Mapped[datetime]
    disabled: Mapped[str | None] = mapped_column(default=None)  # why nothing is sent to it


class Delivery(Base):
    """A message to a webhook, which is retried until it arrives or is given up."""

    __tablename__ = "deliveries"
    __table_args__ = (Index("ix_deliveries_next", "next_at"),)

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    webhook_id: Mapped[int] = mapped_column(ForeignKey("webhooks.id"), index=True)
    event: Mapped[str] = mapped_column(unique=True)  # identifier of the message, equal in all attempts
    created: Mapped[datetime]
    payload: Mapped[dict[str, Any]] = mapped_column(JSON)
    attempts: Mapped[int] = mapped_column(default=0)
    next_at: Mapped[datetime | None] = mapped_column(default=None)  # None: delivered, or given up
    delivered: Mapped[datetime | None] = mapped_column(default=None)
    problem: Mapped[str] = mapped_column(default="")  # of the last attempt, in one line
