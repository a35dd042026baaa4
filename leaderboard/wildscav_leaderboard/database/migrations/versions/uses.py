"""Uses of what may be used a few times in a minute."""

import sqlalchemy as sa
from alembic import op

revision = "3"
down_revision = "2"


def upgrade() -> None:
    """Add their table."""
    op.create_table(
        "uses",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("key", sa.String(), nullable=False),
        sa.Column("at", sa.DateTime(), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_uses")),
    )
    for column in ("at", "key"):
        op.create_index(op.f(f"ix_uses_{column}"), "uses", [column])


def downgrade() -> None:
    """Drop it."""
    op.drop_table("uses")
