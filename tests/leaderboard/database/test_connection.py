"""One writer at a time, on every database; readers see one state and change nothing."""

from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime

import pytest
from sqlalchemy import func, select

from wildscav.errors import UserError
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.models import Announcement
from wildscav_leaderboard.seasons.state import read_state, write_state

NOON = datetime(2030, 6, 1, 12, tzinfo=UTC)


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
            session.add(Announcement(at=NOON, author="ada", title="Welcome", text=""))
            session.flush()
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    with database.reading() as session:
        assert session.scalar(select(func.count()).select_from(Announcement)) == 0


def test_what_a_reader_changes_is_lost(database: Database) -> None:
    with database.reading() as session:
        session.add(Announcement(at=NOON, author="ada", title="Welcome", text=""))
    with database.reading() as session:
        assert session.scalar(select(func.count()).select_from(Announcement)) == 0


def test_a_reader_sees_one_state_while_others_write(database: Database) -> None:
    count_up(database)
    with database.reading() as session:
        assert read_state(session, "counter") == {"value": 1}
        count_up(database)
        session.expire_all()
        assert read_state(session, "counter") == {"value": 1}


def test_a_moment_keeps_its_time_zone(database: Database) -> None:
    with database.writing() as session:
        session.add(Announcement(at=NOON, author="ada", title="Welcome", text=""))
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
