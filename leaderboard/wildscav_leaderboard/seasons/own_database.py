"""Opening the database of a season, and of no other one."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path

from sqlalchemy.orm import Session

from wildscav.errors import UserError
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.database.schema import check_is_current, version_of
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.state import SEASON, read_state, write_state


@contextmanager
def opened(season: Season, *, any_version: bool = False) -> Iterator[Database]:
    """Yield a season's database, and close it afterwards. An empty one gets its tables, an older one stays.

    Args:
        season: The season. Other users of this machine can read nothing of it from now on.
        any_version: Whether the database may have the tables of an older version.

    Raises:
        UserError: The database is another season's, or of another version.
        DatabaseError: It cannot be reached.
    """
    database = season.database()
    try:
        with database.reading() as session:
            version = version_of(session.connection())
            if version is not None and not any_version:
                check_is_current(session.connection(), str(database))
        if version is None:
            database.upgrade()
        with database.reading() as session:
            is_known = _check_own(session, season, database)
        if not is_known:
            with database.writing() as session:
                own = {"name": season.settings.name, "commitment": season.seed.commitment}
                write_state(session, SEASON, own, datetime.now(UTC))
        _close_to_others(season, database)
        yield database
    finally:
        database.close()


def _check_own(session: Session, season: Season, database: Database) -> bool:
    """Return whether a database knows that it is this season's.

    Raises:
        UserError: It is another one's.
    """
    known = read_state(session, SEASON)
    if known is not None and known["commitment"] != season.seed.commitment:
        raise UserError(
            f"the database {database} is of another season, {known['name']}, whose secret is not the one in "
            f"{season.folder}: check `database` in its settings and WILDSCAV_SEASON_DATABASE",
            exit_code=2,
        )
    return known is not None


def _close_to_others(season: Season, database: Database) -> None:
    """Take from others what they might do with a season's folder, files and database of SQLite."""
    file = (database.url.database or "") if database.kind == "sqlite" else ""
    for path in (season.folder, *season.folder.iterdir(), season.files, Path(file or season.folder)):
        with suppress(OSError):  # it is another user's, or not there yet
            path.chmod(path.stat().st_mode & 0o700)
