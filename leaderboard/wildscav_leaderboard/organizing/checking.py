"""Checking a season: that everything is there that it needs, and as it was when it was stored."""

from collections.abc import Iterator
from contextlib import closing, suppress
from dataclasses import dataclass, field
from pathlib import Path

from sqlalchemy import select, text
from sqlalchemy.orm import Session

from wildscav.errors import UserError
from wildscav_leaderboard.conductor.editions import edition_changes
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.database.schema import check_is_current
from wildscav_leaderboard.organizing.backups.backup import OnProgress, upgraded
from wildscav_leaderboard.organizing.stored_files import stored_files
from wildscav_leaderboard.seasons.folder import FINAL_SECRET_FILE, SECRET_FILE, Season
from wildscav_leaderboard.seasons.initial_files import COMMITMENTS_FILE, commitments_text
from wildscav_leaderboard.seasons.models import EditionRow
from wildscav_leaderboard.seasons.own_database import opened
from wildscav_leaderboard.seasons.state import is_decided
from wildscav_leaderboard.submissions.archives import load_archive
from wildscav_leaderboard.submissions.service import taking_part


@dataclass
class Checked:
    """What was found."""

    files: int = 0  # that were checked
    problems: list[str] = field(default_factory=list)
    changes: list[str] = field(default_factory=list)  # of the rules, which are not in force yet
    longest: dict[str, float] = field(default_factory=dict)  # s that agents can make a match last, by track
    note: str = ""  # why the database was not checked

    @property
    def passed(self) -> bool:
        """Whether nothing is wrong."""
        return not self.problems


def check_season(folder: Path, on_progress: OnProgress = lambda *_: None) -> Checked:
    """Check a season's settings, secrets and database, and every file that the database refers to.

    It only reads, and may be run at any time.

    Args:
        on_progress: Called after every file.

    Raises:
        UserError: The settings are not valid, or a secret cannot be read.
    """
    season = Season.open(folder)
    found = Checked(longest={track: season.bound(track) for track in season.settings.tracks})
    found.problems += _wrong_commitments(season)
    try:
        with closing(season.database()) as database:
            if database.kind == "sqlite" and not Path(database.url.database or "").is_file():
                found.note = f"there is no database {database} yet: `wildscav season serve` makes it"
                if season.files.exists():  # it ran
                    raise UserError(found.note)
                return found
            _check_database(database)
            _check_files(season, database, found, on_progress)
            with database.reading() as session:
                found.changes += [one.text for one in edition_changes(session, season)]
                found.problems += entries_without_model(session, season)
    except UserError as error:
        found.problems.append(str(error))
    return found


def entries_without_model(session: Session, season: Season) -> Iterator[str]:
    """Yield a line for each entry that asks a model where the settings no longer offer the one they did."""
    written = (season.as_written or season).settings
    editions = session.scalars(select(EditionRow.document))
    if (
        written.model is not None
        or is_decided(session)
        or all(one["conditions"].get("model") is None for one in editions)
    ):
        return
    entries = {one.id: one for track in written.tracks for one, _ in taking_part(session, track)}
    for number, one in entries.items():
        with suppress(UserError):  # a missing archive has a line of its own
            if load_archive(season, one.archive, one.entrant).manifest.model:
                yield (
                    f"submission {number}, {one.name} {one.version}, asks a language model, and the settings "
                    "offer none: its matches will be its own faults"
                )


def check_rules(season: Season) -> list[str]:
    """Check the secrets of a season that is about to run, and bring its database up to date.

    Returns:
        What was done, and the changes of its rules that are not in force yet.

    Raises:
        UserError: The secrets are not those whose commitments were published, or the database cannot be used.
    """
    for problem in wrong_secrets(season.folder):
        raise UserError(problem)
    done = list(upgraded(season))
    with opened(season) as database, database.reading() as session:
        changes = [one.text for one in edition_changes(session, season)]
    return [*done, *changes, *(["`wildscav season apply` brings this into force"] if changes else [])]


def _wrong_commitments(season: Season) -> Iterator[str]:
    path = season.folder / COMMITMENTS_FILE
    if not path.is_file():
        yield f"{path} is missing, so nobody can tell whether the secrets are still those of the beginning"
    yield from wrong_secrets(season.folder)


def wrong_secrets(folder: Path) -> Iterator[str]:
    """Yield that the secrets are not those whose commitments were noted when the season was made."""
    path = folder / COMMITMENTS_FILE
    secrets = [(folder / name).read_bytes() for name in (SECRET_FILE, FINAL_SECRET_FILE)]
    if path.is_file() and path.read_text("utf-8", "replace") != commitments_text(*secrets):
        yield f"the secrets do not have the commitments in {path}, which were published: put the files back"


def _check_database(database: Database) -> None:
    """Check that the database is whole, and has the current schema."""
    with database.reading() as session:
        check_is_current(session.connection(), str(database))
        if database.kind == "sqlite":
            state = session.execute(text("PRAGMA integrity_check")).scalars().all()
            if state != ["ok"]:
                raise UserError(f"the database {database} is damaged: {state[0]}; restore a backup")


def _check_files(season: Season, database: Database, found: Checked, on_progress: OnProgress) -> None:
    with database.reading() as session:
        files = list(stored_files(session, season))
    for file in files:
        problem = file.problem()
        if problem:
            found.problems.append(problem)
        found.files += 1
        on_progress(found.files, len(files))
