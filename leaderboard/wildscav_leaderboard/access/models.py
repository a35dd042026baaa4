"""The table of what is counted for a minute."""

from datetime import datetime

from sqlalchemy.orm import Mapped, mapped_column

from wildscav_leaderboard.database.base import Base


class Use(Base):
    """One use of something that may be used a few times in a minute."""

    __tablename__ = "uses"

    id: Mapped[int] = mapped_column(primary_key=True, init=False)
    key: Mapped[str] = mapped_column(index=True)  # digest of what is used, and by whom
    at: Mapped[datetime] = mapped_column(index=True)
