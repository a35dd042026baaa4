"""Opening the database, and the one line that says why it cannot be opened."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy import Engine, create_engine, inspect
from sqlalchemy.exc import DatabaseError, OperationalError
from sqlalchemy.orm import Session

from wildscav.errors import UserError
from wildscav_leaderboard.models import Base


@contextmanager
def writing(path: Path) -> Iterator[Session]:
    """Open a database to write, made if it is missing. All is written at the end, or nothing.

    Raises:
        UserError: It cannot be made or written, or is something else.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"cannot make the folder of the database {path}: {error.strerror}") from error
    with _one_line(path), _engine(path) as engine:
        Base.metadata.create_all(engine)
        with Session(engine) as session, session.begin():
            yield session


@contextmanager
def reading(path: Path) -> Iterator[Session]:
    """Open a database to read.

    Raises:
        UserError: It is missing, or not a leaderboard's.
    """
    if not path.is_file():
        raise UserError(
            f"there is no database {path}: `wildscav evaluate` makes it, or name another with --db", 2
        )
    with _one_line(path), _engine(path) as engine:
        missing = set(Base.metadata.tables) - set(inspect(engine).get_table_names())
        if missing:
            raise UserError(f"{path} is a database, but not a leaderboard's: name another with --db", 2)
        with Session(engine) as session:
            yield session


@contextmanager
def _engine(path: Path) -> Iterator[Engine]:
    engine = create_engine(f"sqlite:///{path}")
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
