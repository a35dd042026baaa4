"""Version 2: the sandbox of an evaluation, and the limits that it enforced."""

import sqlalchemy as sa
from alembic import op

revision = "2"
down_revision = "1"

KEY = ("submission_id", "track", "suite", "seed", "engine_version")


def upgrade() -> None:
    """Add the columns; for older evaluations their values are unknown."""
    # The old constraint has no name; the convention gives it one, so that it can be dropped.
    with op.batch_alter_table(
        "evaluations", naming_convention={"uq": "uq_%(table_name)s_%(column_0_name)s"}
    ) as table:
        table.add_column(sa.Column("sandbox", sa.String, nullable=False, server_default="unknown"))
        table.add_column(sa.Column("limits", sa.String, nullable=False, server_default="{}"))
        table.drop_constraint("uq_evaluations_submission_id", type_="unique")
        table.create_unique_constraint("one_result", [*KEY, "sandbox", "limits"])
