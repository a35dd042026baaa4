"""The migrations make the tables that the models describe, on every database, and take them back."""

import importlib
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from sqlalchemy import create_engine, inspect, text

import wildscav_leaderboard
from wildscav.errors import UserError
from wildscav_leaderboard.database.base import Base
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.database.schema import VERSION_TABLE, take_back_to, version_of

for file in Path(wildscav_leaderboard.__file__).parent.glob("*/models.py"):
    if file.parent.name != "results":
        importlib.import_module(f"wildscav_leaderboard.{file.parent.name}.models")


def test_migrations_make_exactly_the_tables_of_the_models(database: Database) -> None:
    engine = create_engine(database.url)
    with engine.connect() as connection:
        options = {"version_table": VERSION_TABLE, "compare_type": True}
        context = MigrationContext.configure(connection, opts=options)
        assert compare_metadata(context, Base.metadata) == []
    engine.dispose()


def test_an_upgrade_can_be_taken_back_and_repeated(database: Database) -> None:
    engine = create_engine(database.url)
    with engine.begin() as connection:
        take_back_to(connection, "base")
    with engine.connect() as connection:
        assert set(inspect(connection).get_table_names()) <= {VERSION_TABLE}
        assert version_of(connection) is None
    database.upgrade()
    with engine.connect() as connection:
        assert "submissions" in inspect(connection).get_table_names()
    engine.dispose()


def test_a_database_of_something_else_is_left_alone(empty_url: str) -> None:
    engine = create_engine(empty_url)
    with engine.begin() as connection:
        connection.execute(text("CREATE TABLE recipes (id INTEGER)"))
    database = Database(empty_url)

    with pytest.raises(UserError, match="a season needs a database of its own"):
        database.upgrade()

    with engine.connect() as connection:
        assert inspect(connection).get_table_names() == ["recipes"]
    database.close()
    engine.dispose()


def test_a_database_of_a_newer_version_is_refused(database: Database) -> None:
    with database.writing() as session:
        session.execute(text("UPDATE season_version SET version_num = '999'"))
    with pytest.raises(UserError, match="newer version"):
        database.upgrade()
