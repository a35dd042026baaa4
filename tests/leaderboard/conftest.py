"""Databases of seasons."""

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from httpx import create_ssl_context
from pwdlib.hashers.argon2 import Argon2Hasher
from tests.leaderboard.filled_season import HOSTILE, FilledSeason, filled_season
from tests.leaderboard.hosting.clients import Site, serving_filled
from tests.leaderboard.made_once import made_once
from tests.leaderboard.played_seasons import play_season
from tests.leaderboard.postgresql import PostgreSQL, missing, postgresql_server
from tests.unlimited import call_here

from wildscav_evaluator.submissions import archives
from wildscav_leaderboard.accounts import passwords
from wildscav_leaderboard.database import connection
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.publishing.export import export
from wildscav_leaderboard.seasons.folder import Season


@pytest.fixture(scope="session", autouse=True)
def quick_beginnings(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Do what most tests begin with once, or more cheaply.

    One SQLite database is migrated, of which all are copies, and nothing waits for the disk. Passwords are
    hashed quickly, archives are unpacked in this process, and the system's certificates are read once.
    """
    template, upgrade = tmp_path_factory.mktemp("template") / "season.db", Database.upgrade

    def quick(database: Database) -> None:
        file = Path(database.url.database or "")
        if database.kind == "sqlite" and not file.exists():
            shutil.copy(template, file)
        else:
            upgrade(database)

    prepare = connection._prepare_sqlite

    def prepare_quickly(opened: Any, record: Any) -> None:
        prepare(opened, record)
        opened.execute("PRAGMA synchronous = OFF").close()

    made = Database(f"sqlite:///{template}")
    made.upgrade()
    made.close()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(connection, "_prepare_sqlite", prepare_quickly)
        patch.setattr(Database, "upgrade", quick)
        cheap = Argon2Hasher(time_cost=1, memory_cost=8, parallelism=1)
        patch.setattr(passwords, "Argon2Hasher", lambda: cheap)
        patch.setattr(archives, "call_limited", call_here)
        patch.setattr("httpx._transports.default.create_ssl_context", cache(create_ssl_context))
        yield


@pytest.fixture(scope="session")
def postgresql() -> Iterator[PostgreSQL]:
    """A PostgreSQL server."""
    if why := missing():
        pytest.skip(why)
    with postgresql_server() as server:
        yield server


@pytest.fixture(params=["sqlite", "postgresql"])
def empty_url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """The URL of an empty database of each kind."""
    if request.param == "sqlite":
        return f"sqlite:///{tmp_path / 'season.db'}"
    server: PostgreSQL = request.getfixturevalue("postgresql")
    return server.new_database()


@pytest.fixture(scope="session")
def migrated(postgresql: PostgreSQL) -> str:
    """The name of a database of the server, with all tables, of which others are copies."""
    made = Database(postgresql.new_database())
    made.upgrade()
    made.close()
    return str(made.url.database)


@pytest.fixture(params=["sqlite", "postgresql"])
def database(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Database]:
    """A season's database of each kind, with all tables."""
    if request.param == "sqlite":
        opened = Database(f"sqlite:///{tmp_path / 'season.db'}")
        opened.upgrade()
    else:
        server: PostgreSQL = request.getfixturevalue("postgresql")
        opened = Database(server.new_database(request.getfixturevalue("migrated")))
    yield opened
    opened.close()


@pytest.fixture(scope="session")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of all processes of the tests."""
    base = tmp_path_factory.getbasetemp()
    return base.parent if "PYTEST_XDIST_WORKER" in os.environ else base


@pytest.fixture(scope="module")
def played(shared: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Season, Database]]:
    """A season that was played; its secrets are not opened yet."""
    folder = tmp_path_factory.mktemp("played") / "copy"
    shutil.copytree(made_once(shared / "played", play_season), folder)
    season = Season.open(folder / "season")
    database = season.database()
    yield season, database
    database.close()


@pytest.fixture(scope="session")
def new_filled_season(
    shared: Path, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Callable[..., FilledSeason]]:
    """Make a filled season, with arguments of ``filled_season``."""
    with ExitStack() as stack:

        def made(**more: Any) -> FilledSeason:
            filled = filled_season(shared, tmp_path_factory.mktemp("filled") / "copy", **more)
            stack.callback(filled.database.close)
            return filled

        yield made


@pytest.fixture(scope="session")
def hostile_season(new_filled_season: Callable[..., FilledSeason]) -> FilledSeason:
    """A season whose people and agents write texts that would take over a page, if they could."""
    filled = new_filled_season(words=HOSTILE)
    filled.give_records(b"no record that could be rendered")
    return filled


@pytest.fixture(scope="session")
def hostile_site(hostile_season: FilledSeason) -> Iterator[Site]:
    """That season, served."""
    with serving_filled(hostile_season) as site:
        yield site


@pytest.fixture(scope="module")
def exported(played: tuple[Season, Database], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What is published of a played season before its secrets are opened."""
    folder = tmp_path_factory.mktemp("exported") / "season"
    export(*played, folder)
    return folder
