"""One writer at a time, one state for each reader, and migrations that make the tables of the models."""

import importlib
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from sqlalchemy import create_engine, func, inspect, select, text

import wildscav_leaderboard
from wildscav.errors import UserError
from wildscav_leaderboard.database.base import Base
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.database.schema import VERSION_TABLE, take_back_to, version_of
from wildscav_leaderboard.seasons.models import Announcement
from wildscav_leaderboard.seasons.state import read_state, write_state

NOON = datetime(2030, 6, 1, 12, tzinfo=UTC)


WELCOME = {"at": NOON, "author": "ada", "title": "Welcome", "text": ""}


def announced(database: Database) -> int:
    with database.reading() as session:
        return session.scalar(select(func.count()).select_from(Announcement)) or 0


def count_up(database: Database) -> None:
    with database.writing() as session:
        old = read_state(session, "counter") or {"value": 0}
        write_state(session, "counter", {"value": old["value"] + 1}, NOON)


def test_no_change_is_lost_when_many_write_at_once(database: Database) -> None:
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda _: count_up(database), range(100)))
    with database.reading() as session:
        assert read_state(session, "counter") == {"value": 100}


def test_an_error_leaves_nothing_half_written(database: Database) -> None:
    def fail() -> None:
        with database.writing() as session:
            session.add(Announcement(**WELCOME))
            session.flush()
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    assert announced(database) == 0


def test_what_a_reader_changes_is_lost(database: Database) -> None:
    with database.reading() as session:
        session.add(Announcement(**WELCOME))
    assert announced(database) == 0


def test_a_reader_sees_one_state_while_others_write(database: Database) -> None:
    count_up(database)
    with database.reading() as session:
        assert read_state(session, "counter") == {"value": 1}
        count_up(database)
        session.expire_all()
        assert read_state(session, "counter") == {"value": 1}


def test_a_moment_keeps_its_time_zone(database: Database) -> None:
    with database.writing() as session:
        session.add(Announcement(**WELCOME))
    with database.reading() as session:
        assert session.scalars(select(Announcement)).one().at == NOON


@pytest.mark.parametrize("url", ["season.db", "mysql://there/db", "", "sqlite"])
def test_a_url_of_no_known_kind_is_refused(url: str) -> None:
    with pytest.raises(UserError, match="is no URL such as"):
        Database(url)


def test_a_server_that_is_not_there_gives_one_line_without_the_password() -> None:
    database = Database("postgresql://ada:sesame@127.0.0.1:1/season")
    with pytest.raises(UserError, match="cannot be used") as caught:
        database.check()
    assert "sesame" not in str(caught.value)
    assert "\n" not in str(caught.value)
    database.close()


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
