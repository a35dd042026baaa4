"""On which tracks a submission takes part, whether its team keeps it, and which one it is to replace."""

import sqlalchemy as sa
from alembic import op

revision = "4"
down_revision = "3"


def upgrade() -> None:
    """Add them: until now a submission took part on all of its tracks."""
    with op.batch_alter_table("submissions") as table:
        table.add_column(sa.Column("playing", sa.JSON(), nullable=False, server_default="[]"))
        table.add_column(sa.Column("kept", sa.Boolean(), nullable=False, server_default=sa.false()))
        table.add_column(sa.Column("replaces", sa.Integer(), nullable=True))
    op.execute("UPDATE submissions SET playing = tracks WHERE state = 'active'")


def downgrade() -> None:
    """Drop them."""
    with op.batch_alter_table("submissions") as table:
        for name in ("playing", "kept", "replaces"):
            table.drop_column(name)
