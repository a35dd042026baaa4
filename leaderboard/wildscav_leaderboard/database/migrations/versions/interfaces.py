"""The interfaces of submissions, which boards show."""

import sqlalchemy as sa
from alembic import op

revision = "4"
down_revision = "3"


def upgrade() -> None:
    """Add the column: in releases before it, all submissions played by numbers."""
    op.add_column("submissions", sa.Column("interface", sa.String(), nullable=True))


def downgrade() -> None:
    """Drop it."""
    with op.batch_alter_table("submissions") as table:
        table.drop_column("interface")
