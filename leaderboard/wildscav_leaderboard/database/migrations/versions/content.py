"""The content of submissions, without labels; ratings of ladders follow from places alone."""

import sqlalchemy as sa
from alembic import op

revision = "3"
down_revision = "2"

SKILL = ("mu", "sigma")


def upgrade() -> None:
    """Add the digest, which is unknown for older submissions, and drop the skills."""
    with op.batch_alter_table("submissions") as table:
        table.add_column(sa.Column("content", sa.String(), nullable=False, server_default=""))
    with op.batch_alter_table("ladder_steps") as table:
        for name in SKILL:
            table.drop_column(name)


def downgrade() -> None:
    """Drop the digest; an older version computes the skills of later matches from OpenSkill's first ones."""
    with op.batch_alter_table("ladder_steps") as table:
        table.add_column(sa.Column("mu", sa.Double(), nullable=False, server_default="25.0"))
        table.add_column(sa.Column("sigma", sa.Double(), nullable=False, server_default="8.333333"))
    with op.batch_alter_table("submissions") as table:
        table.drop_column("content")
