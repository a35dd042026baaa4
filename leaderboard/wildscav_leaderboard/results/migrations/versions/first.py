"""Version 1: submissions, their evaluations, and the scores and matches of evaluations."""

import sqlalchemy as sa
from alembic import op

revision = "1"
down_revision = None


def upgrade() -> None:
    """Make the tables."""
    op.create_table(
        "submissions",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("name", sa.String, nullable=False),
        sa.Column("version", sa.String, nullable=False),
        sa.Column("digest", sa.String, nullable=False),
        sa.UniqueConstraint("name", "version", "digest"),
    )
    op.create_index("ix_submissions_name", "submissions", ["name"])
    op.create_table(
        "evaluations",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("submission_id", sa.Integer, sa.ForeignKey("submissions.id"), nullable=False),
        sa.Column("track", sa.String, nullable=False),
        sa.Column("suite", sa.String, nullable=False),
        sa.Column("seed", sa.String, nullable=False),
        sa.Column("engine_version", sa.String, nullable=False),
        sa.Column("started", sa.DateTime, nullable=False),
        sa.Column("faults", sa.Integer, nullable=False),
        sa.UniqueConstraint("submission_id", "track", "suite", "seed", "engine_version"),
    )
    _make_parts_of_evaluations()


def _make_parts_of_evaluations() -> None:
    op.create_table(
        "scores",
        sa.Column("evaluation_id", sa.Integer, sa.ForeignKey("evaluations.id"), primary_key=True),
        sa.Column("position", sa.Integer, primary_key=True),
        sa.Column("name", sa.String, nullable=False),
        sa.Column("title", sa.String, nullable=False),
        sa.Column("unit", sa.String, nullable=False),
        sa.Column("lower_is_better", sa.Boolean, nullable=False),
        sa.Column("mean", sa.Double, nullable=False),
        sa.Column("std", sa.Double),
        sa.Column("low", sa.Double, nullable=False),
        sa.Column("high", sa.Double, nullable=False),
    )
    op.create_table(
        "match_results",
        sa.Column("evaluation_id", sa.Integer, sa.ForeignKey("evaluations.id"), primary_key=True),
        sa.Column("index", sa.Integer, primary_key=True),
        sa.Column("status", sa.String, nullable=False),
        sa.Column("fault", sa.String),
        sa.Column("detail", sa.String, nullable=False),
        sa.Column("metrics", sa.JSON),
    )
