"""Opening a season's database, for reading and for writing.

There is one writer at a time, whatever the database: SQLite locks its file at the beginning of a writing
transaction, and in PostgreSQL a writing transaction takes an advisory lock first. So a decision and what
follows from it are never separated by another process's change, and nobody needs to think about races.
Readers never wait.
"""

from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from typing import Any, TypeVar

from sqlalchemy import URL, Connection, Engine, create_engine, event, make_url, text
from sqlalchemy.exc import ArgumentError, DBAPIError
from sqlalchemy.orm import Session

from wildscav.errors import UserError

BUSY_TIMEOUT = 30.0  # s that a writer waits for another one
WRITERS = 0x57494C44  # number of the advisory lock that writers take in PostgreSQL
READERS = 10  # requests that read at a time, of the 15 connections that a process has
KINDS = ("sqlite", "postgresql")
KEPT = "kept"  # in the info of sessions that read: what follows from what was read, kept for the next ones
COMMITTED = "committed"  # the same in the info of sessions that write, which keep nothing: they may be undone
READ = "read"  # there as well: what the session has read, and need not read again

Found = TypeVar("Found")


class DatabaseError(UserError):
    """The season's database cannot be used."""


class Database:
    """A season's database. It may be used from several threads; a session belongs to one.

    Args:
        url: ``sqlite:////absolute/path`` or ``postgresql://user:password@host/name``.

    Raises:
        DatabaseError: It is no such URL.
    """

    def __init__(self, url: str) -> None:
        self.url = parse_url(url)
        self._readers = _engine(self.url, "REPEATABLE READ")
        self._kept: dict[Hashable, Any] = {}
        # A writer must see what the one before it wrote while it waited for the lock.
        self._writers = _engine(self.url, "READ COMMITTED")
        if self.url.get_backend_name() == "sqlite":
            _begin_with(self._readers, "BEGIN")
            _begin_with(self._writers, "BEGIN IMMEDIATE")
        else:
            _begin_with(self._writers, f"SELECT pg_advisory_xact_lock({WRITERS})")

    @property
    def kind(self) -> str:
        """The kind of database: ``sqlite`` or ``postgresql``."""
        return self.url.get_backend_name()

    def __str__(self) -> str:
        return self.url.render_as_string(hide_password=True)

    @contextmanager
    def reading(self) -> Iterator[Session]:
        """Yield a session that sees one state of the database throughout; what it changes is lost.

        Raises:
            DatabaseError: The database cannot be reached.
        """
        info = {KEPT: self._kept}
        with self._reported(), Session(self._readers, expire_on_commit=False, info=info) as session:
            yield session

    @contextmanager
    def writing(self) -> Iterator[Session]:
        """Yield a session of the only writer. At the end of the block everything is stored, or nothing.

        Raises:
            DatabaseError: The database cannot be reached, or another writer holds it too long.
        """
        info = {COMMITTED: self._kept}
        with (
            self._reported(),
            Session(self._writers, expire_on_commit=False, info=info) as session,
            session.begin(),
        ):
            yield session

    def upgrade(self) -> None:
        """Make the tables, or give those of an older version the current schema.

        Raises:
            DatabaseError: The database cannot be used, or is not a season's, or of a newer version.
        """
        # Imports Alembic, which a web server does not need.
        from wildscav_leaderboard.database.schema import bring_to, check_known

        with self._reported(), self._writers.connect() as connection:
            if self.kind == "sqlite":  # which changes a table by copying it, and others refer to it meanwhile
                connection.connection.cursor().execute("PRAGMA foreign_keys = OFF")
            with connection.begin():
                check_known(connection, str(self))
                bring_to(connection)
            connection.invalidate()

    def check(self) -> None:
        """Check that the database can be reached, for health checks.

        Raises:
            DatabaseError: It cannot.
        """
        with self.reading() as session:
            session.execute(text("SELECT 1"))

    def close(self) -> None:
        """Close all connections."""
        self._readers.dispose()
        self._writers.dispose()

    @contextmanager
    def _reported(self) -> Iterator[None]:
        """Turn a lost connection into one line; everything else is a mistake of ours."""
        try:
            yield
        except DBAPIError as error:
            if not error.connection_invalidated and type(error).__name__ != "OperationalError":
                raise
            reason = str(error.orig).strip().splitlines()[0]
            raise DatabaseError(f"the database {self} cannot be used: {reason}") from error


def clock(session: Session) -> datetime:
    """Return the time of the database, on which all hosts agree whatever their own clocks say.

    It is that of PostgreSQL's server. A file of SQLite is used by one host, whose clock it is then.
    """
    if session.get_bind().dialect.name != "postgresql":
        return datetime.now(UTC)
    # Not now(), which stands still while a writer waits for its turn.
    moment: datetime = session.execute(text("SELECT clock_timestamp()")).scalar_one()
    return moment.astimezone(UTC)


def once(session: Session, key: Hashable, read: Callable[[], Found]) -> Found:
    """Read something once in a session that reads, since such a session sees one state of the database.

    Args:
        session: A session; one that writes reads anew.
    """
    if KEPT not in session.info:
        return read()
    found: dict[Hashable, Found] = session.info.setdefault(READ, {})
    if key not in found:
        found[key] = read()
    return found[key]


def parse_url(url: str) -> URL:
    """Return the URL of a database, with the driver that is used for its kind.

    Raises:
        DatabaseError: It is no URL of a database of a known kind.
    """
    try:
        parsed = make_url(url)
    except ArgumentError:
        parsed = None
    if parsed is None or parsed.get_backend_name() not in KINDS:
        raise DatabaseError(
            "the database is no URL such as sqlite:////srv/season.db or postgresql://user@host/name", 2
        )
    return parsed.set(drivername="postgresql+psycopg") if parsed.get_backend_name() == KINDS[1] else parsed


def _engine(url: URL, isolation: str) -> Engine:
    if url.get_backend_name() == "sqlite":
        engine = create_engine(url, connect_args={"timeout": BUSY_TIMEOUT, "check_same_thread": False})
        event.listen(engine, "connect", _prepare_sqlite)
        return engine
    try:
        return create_engine(url, pool_pre_ping=True, isolation_level=isolation)
    except ModuleNotFoundError as error:
        raise DatabaseError(
            f"{error.name} is not installed: pip install 'wildscav[postgresql]' adds what PostgreSQL needs", 2
        ) from error


def _prepare_sqlite(connection: Any, _record: Any) -> None:
    """Set up a new connection to SQLite; transactions are begun by ``_begin_with``."""
    connection.isolation_level = None
    for setting in ("journal_mode = WAL", "synchronous = FULL", "foreign_keys = ON"):
        connection.execute(f"PRAGMA {setting}").close()


def _begin_with(engine: Engine, statement: str) -> None:
    """Let a statement begin every transaction."""

    def begin(connection: Connection) -> None:
        connection.exec_driver_sql(statement)

    event.listen(engine, "begin", begin)
