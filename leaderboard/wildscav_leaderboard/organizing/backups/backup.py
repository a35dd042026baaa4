"""Writing a backup of a season while it runs.

What the database says at one moment is written first, and then the files that it refers to. These were
complete before the database knew of them, and never change. So it does not matter what happens meanwhile.
Matches that are being played are played again after a restoration.
"""

import json
import os
import tarfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from sqlalchemy import select
from sqlalchemy.orm import Session

from wildscav.errors import UserError, describe
from wildscav.version import __version__
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.database.schema import version_of, versions_of
from wildscav_leaderboard.matches.models import MatchResult
from wildscav_leaderboard.organizing.backups.archive import Writer
from wildscav_leaderboard.organizing.backups.tables import write_tables
from wildscav_leaderboard.organizing.stored_files import stored_files
from wildscav_leaderboard.seasons.folder import DATABASE_FILE, PUBLISHED, Season
from wildscav_leaderboard.seasons.own_database import opened
from wildscav_leaderboard.submissions.models import Submission
from wildscav_server import leftovers

FORMAT = 1
BACKUPS = "backups"  # folder of a season, for those before upgrades
ABOUT = "backup.json"  # the first entry of a backup
SETTINGS, TABLES, FILES = "season", "database", "files"  # folders in a backup
OnProgress = Callable[[int, int], None]  # files that are done, of how many


@dataclass(frozen=True)
class BackedUp:
    """What is in a backup."""

    rows: int
    files: int
    size: int  # bytes
    missing: tuple[str, ...]  # files that the database refers to and that are not there


def upgraded(season: Season) -> Iterator[str]:
    """Give an older database the current schema, after a backup of it alone; yield what is done.

    Raises:
        UserError: The database is another season's, or of a newer version, or cannot be backed up.
    """
    with opened(season, any_version=True) as database:
        with database.reading() as session:
            version, current = versions_of(session.connection(), str(database))
        if version == current:
            return
        now = datetime.now(UTC)
        out = season.folder / BACKUPS / f"{now:%Y-%m-%d-%H%M%S}-version-{version}.tar"
        out.parent.mkdir(mode=0o700, exist_ok=True)
        back_up(season, database, out, now, with_files=False)
        yield f"the database is of an older version (schema {version}): it was backed up to {out}"
        database.upgrade()
        yield f"the database was brought to schema {current}"


def back_up(
    season: Season,
    database: Database,
    out: Path,
    now: datetime,
    on_progress: OnProgress = lambda *_: None,
    *,
    with_files: bool = True,
) -> BackedUp:
    """Write a backup, whole or not at all. It holds the secrets, so only its owner may read it.

    Args:
        database: Its database, of this version or an older one.
        out: The file, which must not exist yet.
        on_progress: Called after every file.
        with_files: Whether archives and records are in it.

    Raises:
        UserError: The file exists, or something cannot be read or written.
        DatabaseError: The database cannot be reached.
    """
    if out.exists():
        raise UserError(f"{out} exists already: a backup is never overwritten", exit_code=2)
    fresh = out.absolute().with_name(f".{out.name}.{os.getpid()}")
    try:
        descriptor = os.open(fresh, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with os.fdopen(descriptor, "wb") as file:
            writer = Writer(file)
            rows, files, missing = _write(writer, season, database, now, on_progress, with_files)
            writer.close()
            file.flush()
            os.fsync(file.fileno())
        size = fresh.stat().st_size
        fresh.rename(out)
    except (OSError, tarfile.TarError) as error:
        raise UserError(f"the backup cannot be written: {describe(error)}") from error
    finally:
        fresh.unlink(missing_ok=True)
    return BackedUp(rows, files, size, missing)


def _write(
    writer: Writer,
    season: Season,
    database: Database,
    now: datetime,
    on_progress: OnProgress,
    with_files: bool,
) -> tuple[int, int, tuple[str, ...]]:
    """Write everything; return how many rows and files there are, and what is missing."""
    with leftovers.temporary_folder("backup-") as place:
        with database.reading() as session:
            about = _about(session, season, now)
            rows = write_tables(session.connection(), place)
            wanted = list(_referred_to(session, season)) if with_files else []
        writer.add_text(json.dumps(about), ABOUT)
        for path in sorted(place.iterdir()):
            writer.add(path, f"{TABLES}/{path.name}")
    own = [(path, f"{SETTINGS}/{path.relative_to(season.folder).as_posix()}") for path in own_files(season)]
    files, missing = [*own, *wanted], []
    for number, (path, name) in enumerate(files, 1):
        try:
            writer.add(path, name)
        except FileNotFoundError:
            missing.append(str(path))
        on_progress(number, len(files))
    return rows, len(files) - len(missing), tuple(missing)


def _about(session: Session, season: Season, now: datetime) -> dict[str, object]:
    return {
        "format": FORMAT,
        "wildscav": __version__,
        "season": season.settings.name,
        "schema": version_of(session.connection()),
        "at": now.isoformat(),
    }


def own_files(season: Season) -> list[Path]:
    """Return the files that people put into the folder: settings, secrets, suites, certificates."""
    others = {season.files, *(season.folder / name for name in (FILES, PUBLISHED, BACKUPS))}
    return sorted(
        path
        for path in season.folder.rglob("*")
        if path.is_file()
        and not path.name.startswith((DATABASE_FILE, "."))
        and others.isdisjoint(path.parents)
    )


def _referred_to(session: Session, season: Season) -> Iterator[tuple[Path, str]]:
    """Yield the files that the database refers to and those beside them, with their names in a backup."""
    paths: dict[Path, None] = {}  # each once, in order
    for file in stored_files(session, season):
        paths[file.path] = None
    folders = [season.submission_folder(number) for number in session.scalars(select(Submission.id))]
    folders += [season.match_folder(number) for number in session.scalars(select(MatchResult.match_id))]
    for folder in folders:
        paths |= dict.fromkeys(path for path in sorted(folder.rglob("*")) if path.is_file())
    for path in paths:
        yield path, f"{FILES}/{path.relative_to(season.files).as_posix()}"
