"""Alembic's environment: it runs on the given connection, in its open transaction."""

from alembic import context

from wildscav_leaderboard.database.base import Base

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=Base.metadata,  # which names constraints
    version_table="season_version",
    render_as_batch=True,  # SQLite can change a table only by copying it
)
context.run_migrations()
