"""Editions, the content of submissions without labels, and on which tracks a submission takes part.

Ratings of ladders follow from places alone, so steps of a ladder lose their skills.
"""

import sqlalchemy as sa
from alembic import op

revision = "2"
down_revision = "1"
BEFORE, NOW = ("kind", "track", "number", "group_id"), ("edition_id", "judging")


def upgrade() -> None:
    """Add all of it: until now a submission took part on all of its tracks, and its content is unknown."""
    op.create_table(
        "editions",
        sa.Column("id", sa.Integer(), primary_key=True),
        sa.Column("track", sa.String(), nullable=False),
        sa.Column("digest", sa.String(), nullable=False),
        sa.Column("created", sa.DateTime(), nullable=False),
        sa.Column("document", sa.JSON(), nullable=False),
        sa.UniqueConstraint("track", "digest"),
    )
    with op.batch_alter_table("matches") as table:
        table.add_column(sa.Column("edition_id", sa.Integer(), nullable=True))
        table.add_column(sa.Column("judging", sa.Integer(), nullable=False, server_default="1"))
        table.add_column(sa.Column("superseded", sa.DateTime(), nullable=True))
        table.create_foreign_key(op.f("fk_matches_edition_id"), "editions", ["edition_id"], ["id"])
        table.drop_constraint(op.f(f"uq_matches_{'_'.join(BEFORE)}"), type_="unique")
        table.create_unique_constraint(op.f(f"uq_matches_{'_'.join((*BEFORE, *NOW))}"), [*BEFORE, *NOW])
    with op.batch_alter_table("submissions") as table:
        table.add_column(sa.Column("content", sa.String(), nullable=False, server_default=""))
        table.add_column(sa.Column("playing", sa.JSON(), nullable=False, server_default="[]"))
        table.add_column(sa.Column("kept", sa.Boolean(), nullable=False, server_default=sa.false()))
        table.add_column(sa.Column("replaces", sa.Integer(), nullable=True))
    op.execute("UPDATE submissions SET playing = tracks WHERE state = 'active'")
    with op.batch_alter_table("ladder_steps") as table:
        for name in ("mu", "sigma"):
            table.drop_column(name)


def downgrade() -> None:
    """Take all of it back; an older version computes later skills from OpenSkill's first ones."""
    with op.batch_alter_table("ladder_steps") as table:
        table.add_column(sa.Column("mu", sa.Double(), nullable=False, server_default="25.0"))
        table.add_column(sa.Column("sigma", sa.Double(), nullable=False, server_default="8.333333"))
    with op.batch_alter_table("submissions") as table:
        for name in ("content", "playing", "kept", "replaces"):
            table.drop_column(name)
    with op.batch_alter_table("matches") as table:
        table.drop_constraint(op.f(f"uq_matches_{'_'.join((*BEFORE, *NOW))}"), type_="unique")
        table.create_unique_constraint(op.f(f"uq_matches_{'_'.join(BEFORE)}"), list(BEFORE))
        table.drop_constraint(op.f("fk_matches_edition_id"), type_="foreignkey")
        for name in ("superseded", "judging", "edition_id"):
            table.drop_column(name)
    op.drop_table("editions")
