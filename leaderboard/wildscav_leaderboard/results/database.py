"""Opening the database; its errors become one line for the user."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import URL, Connection, Engine, create_engine, inspect
from sqlalchemy.exc import DatabaseError, OperationalError
from sqlalchemy.orm import Session

from wildscav.errors import UserError
from wildscav_server import leftovers

UNNUMBERED = "1"  # version of databases without a version number
FIRST_TABLES = {"submissions", "evaluations", "scores", "match_results"}  # of every version


def is_current(connection: Connection) -> bool:
    """Return whether a database has the current schema."""
    return _version(connection) == _scripts(_config(connection)).get_current_head()


def is_ours(connection: Connection) -> bool:
    """Return whether a database is a leaderboard's, of any version."""
    return set(inspect(connection).get_table_names()) >= FIRST_TABLES


def is_newer(connection: Connection) -> bool:
    """Return whether a database is of a newer, unknown version."""
    known = {script.revision for script in _scripts(_config(connection)).walk_revisions()}
    return is_ours(connection) and _version(connection) not in known


def bring_up_to_date(connection: Connection) -> None:
    """Give an empty or older database of ours the current schema, in the open transaction."""
    config = _config(connection)
    if _named_version(connection) is None and is_ours(connection):
        command.stamp(config, UNNUMBERED)
    command.upgrade(config, "head")


def _version(connection: Connection) -> str | None:
    """Return the version of a database; None if it is not ours."""
    named = _named_version(connection)
    return UNNUMBERED if named is None and is_ours(connection) else named


def _named_version(connection: Connection) -> str | None:
    return MigrationContext.configure(connection).get_current_revision()


def _config(connection: Connection) -> Config:
    config = Config(attributes={"connection": connection})
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations"))
    return config


def _scripts(config: Config) -> ScriptDirectory:
    return ScriptDirectory.from_config(config)


def check_writable(path: Path) -> None:
    """Check that ``writing`` would work, and leave nothing behind.

    An old database is only opened. In the place of a new one a trial is made, in a folder of its own: another
    command may make the database, or its folder, at the same time.

    Raises:
        UserError: It would not.
    """
    if path.exists():
        with _opened_to_write(path):
            return
    there = next(folder for folder in path.absolute().parents if folder.exists())
    with ExitStack() as stack:
        try:
            folder = stack.enter_context(leftovers.temporary_folder_in(there, ".wildscav-"))
        except OSError as error:
            raise UserError(f"cannot make the database {path} in {there}: {error.strerror}") from error
        connection = stack.enter_context(_opened_to_write(folder / path.name, path))
        connection.commit()  # shows a full disk


@contextmanager
def writing(path: Path) -> Iterator[Session]:
    """Open a database to write; create it if it is missing. At the end everything is written, or nothing.

    Raises:
        UserError: It cannot be created or written, or is not a leaderboard's database.
    """
    with _opened_to_write(path) as connection, Session(connection) as session:
        yield session
        session.flush()
        connection.commit()


@contextmanager
def _opened_to_write(path: Path, named: Path | None = None) -> Iterator[Connection]:
    """Yield a connection in a transaction with our tables, which are created or upgraded.

    All of this is lost unless it is committed.

    Args:
        path: The database.
        named: The path to name in errors, if it is another.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"cannot make the folder of the database {path}: {error.strerror}") from error
    with (
        _nothing_half_made(path),
        _one_line(named or path),
        _engine(path) as engine,
        engine.connect() as connection,
    ):
        # Locks the database at once, so that the creation of tables is part of the transaction.
        connection.exec_driver_sql("BEGIN IMMEDIATE")
        if inspect(connection).get_table_names():
            _check_ours(path, connection)
        if not is_current(connection):
            bring_up_to_date(connection)
        yield connection


@contextmanager
def reading(path: Path) -> Iterator[Session]:
    """Open a database to read. One of an older version is upgraded first.

    Raises:
        UserError: It is missing, or not a leaderboard's database.
    """
    if not path.is_file():
        raise UserError(
            f"there is no database {path}: `wildscav evaluate` creates it, or name another with --db", 2
        )
    with _one_line(path), _engine(path) as engine:
        with engine.connect() as connection:
            _check_ours(path, connection)
            old = not is_current(connection)
        if old:
            with writing(path):
                pass
        with engine.connect() as connection, Session(connection) as session:
            yield session


def _check_ours(path: Path, connection: Connection) -> None:
    """Refuse a database that lacks some of our tables, or is of a newer version."""
    if not is_ours(connection):
        raise UserError(f"{path} is a database, but not a leaderboard's: name another with --db", 2)
    if is_newer(connection):
        raise UserError(f"{path} was written by a newer version of Wildscav: name another with --db", 2)


@contextmanager
def _nothing_half_made(path: Path) -> Iterator[None]:
    """Remove the empty file that remains if a new database could not be created."""
    was_there = path.exists()
    try:
        yield
    finally:
        if not was_there and path.is_file() and path.stat().st_size == 0:
            path.unlink()


@contextmanager
def _engine(path: Path) -> Iterator[Engine]:
    engine = create_engine(URL.create("sqlite", database=str(path)))
    try:
        yield engine
    finally:
        engine.dispose()


@contextmanager
def _one_line(path: Path) -> Iterator[None]:
    """Turn the database's own errors into one line for the user."""
    try:
        yield
    except OperationalError as error:
        raise UserError(f"the database {path} cannot be used: {error.orig}") from error
    except DatabaseError as error:
        raise UserError(
            f"{path} is not a leaderboard's database ({error.orig}): name another with --db"
        ) from error
