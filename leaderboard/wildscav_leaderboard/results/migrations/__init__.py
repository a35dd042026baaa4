"""The database's schema, version by version: what Alembic runs to bring a database up to date."""
