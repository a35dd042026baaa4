"""Version 1 of a season's schema."""

from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "1"
down_revision = None

TYPES = {
    "flag": sa.Boolean,
    "int": sa.Integer,
    "json": sa.JSON,
    "real": sa.Double,
    "text": sa.String,
    "time": sa.DateTime,
}

# Each table with its columns: name, type, and what else is so. >table: refers to that table's id. Those that
# others refer to come first.
TABLES = {
    "accounts": "id int key, name text unique, password text, role text, created time, disabled text null",
    "announcements": "id int key, at time, author text, title text, text text",
    "audit_log": "id int key, at time index, actor text, act text, subject text, detail text",
    "boards": "track text key, audience text key, updated time, document json",
    "invitations": "id int key, digest text unique, role text, label text, created time, expires time null,"
    "uses_left int null",
    "leases": "name text key, holder text, epoch int, until time",
    "matches": "id int key, kind text, track text, number int, group_id int, spec json, created time,"
    "since time, state text, priority int, deadline time null, platform_faults int, detail text",
    "season_state": "name text key, value json, updated time",
    "teams": "id int key, name text unique, title text, created time, join_digest text null unique,"
    "disqualified text null",
    "ladder_steps": "match_id int key >matches, entrant text key, track text, conditions text, mu real,"
    "sigma real, place int, fault flag",
    "match_results": "match_id int key >matches, attempt_id int null, at time, row json, timing json,"
    "conditions text, record text, record_size int, fault text null, score real null",
    "members": "account_id int key >accounts, team_id int >teams index, joined time",
    "submissions": "id int key, team_id int >teams index, account_id int >accounts, name text, version text,"
    "message text, tracks json, digest text, archive text, size int, created time index, state text,"
    "since time, deadline time null, platform_faults int, charged flag, fault text null, reason text,"
    "last_lines json, command text",
    "tokens": "id int key, account_id int >accounts index, digest text unique, label text, created time,"
    "used time null, revoked time null",
    "web_sessions": "digest text key, account_id int >accounts index, csrf text, created time, expires time",
    "webhooks": "id int key, team_id int >teams index, url text, secret text, created time,"
    "disabled text null",
    "attempts": "id int key, kind text, number int, epoch int, started time, deadline time,"
    "submission_id int null >submissions index, match_id int null >matches index, begun time null,"
    "ended time null, outcome text null, detail text",
    "board_points": "id int key, track text, submission_id int >submissions, at time, rank int,"
    "last_rank int, score real, low real, high real, matches int",
    "deliveries": "id int key, webhook_id int >webhooks index, event text unique, created time, payload json,"
    "attempts int, next_at time null, delivered time null, problem text",
    "match_seats": "match_id int key >matches, seat int key, submission_id int null >submissions index,"
    "entrant text",
    "transitions": "id int key, submission_id int >submissions index, at time, state text, detail text",
}
# Indexes of several columns, and those whose name says less than their columns do: table, name and columns.
INDEXES = (
    ("matches", "ix_matches_state_priority", "state", "priority", "id"),
    ("matches", "ix_matches_track_kind", "track", "kind", "id", "state"),
    ("ladder_steps", "ix_ladder_steps_track_entrant", "track", "conditions", "entrant", "match_id"),
    ("match_results", "ix_match_results_at", "at"),
    ("submissions", "ix_submissions_state_id", "state", "id"),
    ("attempts", "ix_attempts_ended", "ended"),
    ("board_points", "ix_board_points_track_submission", "track", "submission_id", "at"),
    ("deliveries", "ix_deliveries_next", "next_at"),
)


def upgrade() -> None:
    """Make the tables."""
    for table, columns in TABLES.items():
        indexes = [sa.Index(name, *of) for owner, name, *of in INDEXES if owner == table]
        unique = [sa.UniqueConstraint("kind", "track", "number", "group_id")] if table == "matches" else []
        op.create_table(table, *map(_column, columns.split(",")), *unique, *indexes)


def _column(text: str) -> sa.Column[Any]:
    name, kind, *more = text.split()
    return sa.Column(
        name,
        TYPES[kind](),
        *(sa.ForeignKey(f"{word[1:]}.id") for word in more if word[0] == ">"),
        primary_key="key" in more,
        nullable="null" in more,
        unique="unique" in more or None,
        index="index" in more or None,
    )


def downgrade() -> None:
    """Remove the tables."""
    for table in reversed(TABLES):
        op.drop_table(table)
