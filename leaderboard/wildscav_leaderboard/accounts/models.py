"""The tables of accounts: people, their tokens and web sessions, and invitations.

Secrets are stored hashed: passwords with argon2; tokens, sessions and keys, which nobody can guess, as
SHA-256.
"""

from datetime import datetime

from sqlalchemy import ForeignKey
from sqlalchemy.orm import Mapped, mapped_column

from wildscav_leaderboard.database.base import Base

COMPETITOR, ORGANIZER = "competitor", "organizer"  # roles


class Account(Base):
    """A person who takes part in the season or organizes it."""

    __tablename__ = "accounts"

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    name: Mapped[str] = mapped_column(unique=True)  # 2 to 40 of a-z, 0-9 and -
    password: Mapped[str]  # hash
    role: Mapped[str]
    created: Mapped[datetime]
    disabled: Mapped[str | None] = mapped_column(default=None)  # why it may not be used


class Token(Base):
    """A token with which a program acts for an account."""

    __tablename__ = "tokens"

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    account_id: Mapped[int] = mapped_column(ForeignKey("accounts.id"), index=True)
    digest: Mapped[str] = mapped_column(unique=True)
    label: Mapped[str]
    created: Mapped[datetime]
    used: Mapped[datetime | None] = mapped_column(default=None)  # about when it was used last
    revoked: Mapped[datetime | None] = mapped_column(default=None)


class WebSession(Base):
    """A browser that is logged in."""

    __tablename__ = "web_sessions"

    digest: Mapped[str] = mapped_column(primary_key=True)  # of the cookie
    account_id: Mapped[int] = mapped_column(ForeignKey("accounts.id"), index=True)
    csrf: Mapped[str]  # the token that forms of this session carry
    created: Mapped[datetime]
    expires: Mapped[datetime]


class Invitation(Base):
    """A key that allows people to register."""

    __tablename__ = "invitations"

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    digest: Mapped[str] = mapped_column(unique=True)
    role: Mapped[str]  # of accounts that are registered with it
    label: Mapped[str]  # for whom it is
    created: Mapped[datetime]
    expires: Mapped[datetime | None] = mapped_column(default=None)
    uses_left: Mapped[int | None] = mapped_column(default=None)  # None: any number
