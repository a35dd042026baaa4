"""Version 3: the versions of simulation, map generator and records, and the key that signed an evaluation."""

import sqlalchemy as sa
from alembic import op

revision = "3"
down_revision = "2"

KEY = ("submission_id", "track", "suite", "seed", "engine_version")
VERSIONS = ("simulation_version", "generator_version", "record_version")
CONDITIONS = ("sandbox", "limits")


def upgrade() -> None:
    """Add the columns; the versions of older evaluations are unknown, and none of them is signed."""
    with op.batch_alter_table("evaluations") as table:
        for name in VERSIONS:
            table.add_column(sa.Column(name, sa.Integer, nullable=False, server_default="0"))
        table.add_column(sa.Column("key", sa.String))
        table.drop_constraint("one_result", type_="unique")
        table.create_unique_constraint("one_result", [*KEY, *VERSIONS, *CONDITIONS])
