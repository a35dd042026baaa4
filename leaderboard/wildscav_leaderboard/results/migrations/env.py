"""Alembic's environment: it runs on the given connection, in its open transaction."""

from alembic import context

context.configure(connection=context.config.attributes["connection"])
context.run_migrations()
