"""Editions: the rules under which the matches of a track are played."""

import sqlalchemy as sa
from alembic import op

revision = "2"
down_revision = "1"
BEFORE, NOW = ("kind", "track", "number", "group_id"), ("edition_id", "judging")


def upgrade() -> None:
    """Add the table of editions, and say of each match under which it is played."""
    op.create_table(
        "editions",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("track", sa.String(), nullable=False),
        sa.Column("digest", sa.String(), nullable=False),
        sa.Column("created", sa.DateTime(), nullable=False),
        sa.Column("document", sa.JSON(), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_editions")),
        sa.UniqueConstraint("track", "digest", name=op.f("uq_editions_track_digest")),
    )
    with op.batch_alter_table("matches") as table:
        table.add_column(sa.Column("edition_id", sa.Integer(), nullable=True))
        table.add_column(sa.Column("judging", sa.Integer(), nullable=False, server_default="1"))
        table.add_column(sa.Column("superseded", sa.DateTime(), nullable=True))
        table.create_foreign_key(op.f("fk_matches_edition_id"), "editions", ["edition_id"], ["id"])
        table.drop_constraint(op.f(f"uq_matches_{'_'.join(BEFORE)}"), type_="unique")
        table.create_unique_constraint(op.f(f"uq_matches_{'_'.join((*BEFORE, *NOW))}"), [*BEFORE, *NOW])


def downgrade() -> None:
    """Take all of it back."""
    with op.batch_alter_table("matches") as table:
        table.drop_constraint(op.f(f"uq_matches_{'_'.join((*BEFORE, *NOW))}"), type_="unique")
        table.create_unique_constraint(op.f(f"uq_matches_{'_'.join(BEFORE)}"), list(BEFORE))
        table.drop_constraint(op.f("fk_matches_edition_id"), type_="foreignkey")
        for name in ("superseded", "judging", "edition_id"):
            table.drop_column(name)
    op.drop_table("editions")
