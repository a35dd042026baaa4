"""Restoring a backup into a new folder and an empty database, whole or not at all."""

import json
import shutil
from contextlib import closing
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from wildscav.errors import UserError
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.database.schema import bring_to, versions_known
from wildscav_leaderboard.organizing.backups.archive import BackupError, extract
from wildscav_leaderboard.organizing.backups.backup import ABOUT, FILES, FORMAT, SETTINGS, TABLES
from wildscav_leaderboard.organizing.backups.tables import is_empty, read_tables
from wildscav_leaderboard.seasons.folder import DATABASE_FILE, Season, place_for


@dataclass(frozen=True)
class Restored:
    """What was restored."""

    season: str
    at: datetime  # of the backup
    rows: int
    database: str


def restore(archive: Path, folder: Path) -> Restored:
    """Restore a backup.

    The database is the one that the settings in the backup name, or WILDSCAV_SEASON_DATABASE: it may be of
    another kind than it was.

    Args:
        folder: The season's folder, which must be missing or empty.

    Raises:
        UserError: The backup is damaged or of a newer version; the folder or the database is not empty.
        DatabaseError: The database cannot be reached.
    """
    folder = folder.absolute()
    with place_for(folder, "the backup cannot be restored") as place:
        extract(archive, place)
        return _restore(archive, place, folder)


def _restore(archive: Path, place: Path, folder: Path) -> Restored:
    """Restore what was extracted."""
    about = _about(archive, place / ABOUT)
    made = place / SETTINGS
    season = Season.open(made)
    files, extracted = season.files, place / FILES
    if files.exists() and any(files.iterdir()):
        raise UserError(f"{files} is not empty: it would hold the season's files", exit_code=2)
    if extracted.exists():
        files.parent.mkdir(parents=True, exist_ok=True)
        shutil.copytree(extracted, files, dirs_exist_ok=True, copy_function=shutil.move)
    # The new database of SQLite becomes part of the folder before that is put into its place.
    is_inside = season.database_url.startswith(f"sqlite:///{made}")
    with closing(season.database()) as database:
        rows = _fill(database, place / TABLES, str(about["schema"]), None if is_inside else (made, folder))
    if is_inside:
        made.rename(folder)
    where = f"sqlite:///{folder / DATABASE_FILE}" if is_inside else str(database)
    return Restored(str(about["season"]), datetime.fromisoformat(str(about["at"])), rows, where)


def _about(archive: Path, path: Path) -> dict[str, object]:
    try:
        about = json.loads(path.read_text("utf-8"))
        if about["format"] == FORMAT:
            return dict(about)
    except (FileNotFoundError, ValueError, LookupError, TypeError):
        raise BackupError(f"{archive} is no backup of a season") from None
    raise BackupError(f"{archive} was written by a newer version of Wildscav")


def _fill(database: Database, tables: Path, version: str, rename: tuple[Path, Path] | None) -> int:
    """Fill an empty database, and put the folder into its place just before the end of the transaction.

    Raises:
        UserError: The database is not empty, or the backup is of a newer version.
    """
    with database.writing() as session:
        connection = session.connection()
        if not is_empty(connection):
            raise UserError(f"the database {database} is not empty: name a new one", exit_code=2)
        if version not in versions_known(connection):
            raise BackupError("the backup was written by a newer version of Wildscav")
        bring_to(connection, version)
        rows = read_tables(connection, tables)
        bring_to(connection)
        if rename is not None:
            rename[0].rename(rename[1])
    return rows
