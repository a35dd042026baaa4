"""Version 4: tournaments."""

import sqlalchemy as sa
from alembic import op

revision = "4"
down_revision = "3"


def upgrade() -> None:
    """Make the table."""
    op.create_table(
        "tournaments",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("identity", sa.String, nullable=False, unique=True),
        sa.Column("track", sa.String, nullable=False),
        sa.Column("suite", sa.String, nullable=False),
        sa.Column("started", sa.DateTime, nullable=False),
        sa.Column("key", sa.String),
        sa.Column("document", sa.JSON, nullable=False),
    )
    op.create_index("ix_tournaments_track", "tournaments", ["track"])
