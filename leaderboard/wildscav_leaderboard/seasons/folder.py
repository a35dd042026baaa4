"""A season's folder, and what is in it."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from wildscav.errors import UserError, describe
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_evaluator.sandbox.limits import DEFAULT_LIMITS, Limits
from wildscav_evaluator.suites.seeds import SuiteSeed, read_secret
from wildscav_evaluator.suites.suite import Suite, matches_in_rounds
from wildscav_evaluator.suites.suite_file import SUFFIX, find_suite, read_suite
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.editions import DECIDING, Edition
from wildscav_leaderboard.seasons.settings import (
    SETTINGS_FILE,
    SeasonSettings,
    SettingsError,
    TrackSettings,
    read_settings,
)
from wildscav_server import leftovers
from wildscav_server.time_limits import Clock

# The seeds of the season's matches, and of those that decide it at its end; private until they are opened.
SECRET_FILE, FINAL_SECRET_FILE = "secret.txt", "final-secret.txt"
DATABASE_FILE = "season.db"
FILES = "files"
PUBLISHED = "published"  # what `wildscav season finalize` exports


@contextmanager
def place_for(folder: Path, failure: str) -> Iterator[Path]:
    """Give a temporary folder beside one that is to be made, in which that is prepared.

    Args:
        folder: The new folder, which must be missing or empty.
        failure: What to say if a file cannot be written.

    Raises:
        UserError: The folder has something in it, or cannot be made.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise UserError(f"{folder} is not an empty folder: name a new one", exit_code=2)
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with leftovers.temporary_folder_in(folder.parent, ".season-") as place:
            yield place
    except OSError as error:
        raise UserError(f"{failure}: {describe(error)}") from error


@dataclass(frozen=True, eq=False)
class Season:
    """A season: its folder and its settings. Everything that changes is in its database."""

    folder: Path  # absolute
    settings: SeasonSettings
    editions: Mapping[str, Edition] = field(default_factory=dict)  # that are in force, by track
    numbers: Mapping[str, int] = field(default_factory=dict)  # of these editions
    as_written: "Season | None" = None  # the season as its folder says, if editions are in force

    @classmethod
    def open(cls, folder: Path) -> "Season":
        """Open the folder that ``wildscav season init`` made.

        Raises:
            SettingsError: Its settings are not valid.
            UserError: Its secret, or a suite, cannot be read.
        """
        folder = folder.absolute()
        season = cls(folder, read_settings(folder))
        season.check()
        return season

    def check(self) -> None:
        """Check what the settings name.

        Raises:
            SettingsError: A suite cannot be read, or does not have the track that names it.
            UserError: The secret cannot be read.
        """
        for track, settings in self.settings.tracks.items():
            place = f"{self.folder / SETTINGS_FILE}: tracks.{track}.suite"
            try:
                found = self.suite(track)
            except UserError as error:
                raise SettingsError(f"{place}: {error}") from None
            if track not in found.tracks:
                raise SettingsError(
                    f"{place}: the suite {settings.suite} has no matches of {track}; it has "
                    f"{', '.join(found.tracks)}"
                )
        _ = self.seed, self.final_seed
        for track in self.settings.tracks:
            try:
                self.bound(track)
            except ValueError as error:
                place = f"{self.folder / SETTINGS_FILE}: tracks.{track}.wall_clock"
                raise SettingsError(f"{place}: {error}") from None

    def with_editions(self, editions: Mapping[str, Edition], numbers: Mapping[str, int]) -> "Season":
        """Return the season with the rules of some editions instead of those of its folder."""
        written = self.as_written or self
        tracks = {name: one for name, one in written.settings.tracks.items() if name in editions}
        for name, edition in editions.items():
            ruled = {setting: getattr(edition.settings, setting) for setting in DECIDING}
            tracks[name] = tracks.get(name, edition.settings).model_copy(update=ruled)
        settings = written.settings.model_copy(update={"tracks": tracks})
        return Season(self.folder, settings, editions, numbers, written)

    @cached_property
    def seed(self) -> SuiteSeed:
        """The seed of all matches. Only its commitment is public until the season is opened."""
        return self._secret(SECRET_FILE)

    @cached_property
    def final_seed(self) -> SuiteSeed:
        """The seed of the matches that decide the season, which nobody has played before."""
        return self._secret(FINAL_SECRET_FILE)

    def _secret(self, name: str) -> SuiteSeed:
        path = self.folder / name
        if not path.is_file():
            raise UserError(
                f"{path} is missing: put it back from a backup, since a new secret would not have the "
                "commitment that was published",
                exit_code=2,
            )
        return read_secret(path)

    @property
    def database_url(self) -> str:
        """The URL of the database; WILDSCAV_SEASON_DATABASE, which may hold a password, comes first."""
        given = os.environ.get("WILDSCAV_SEASON_DATABASE") or self.settings.database
        return given or f"sqlite:///{self.folder / DATABASE_FILE}"

    def database(self) -> Database:
        """Return the database, which is not connected before it is used.

        Raises:
            DatabaseError: Its URL is not valid.
        """
        return Database(self.database_url)

    @property
    def files(self) -> Path:
        """The folder of archives and records; several machines may share it."""
        return self.folder / (self.settings.files or FILES)

    @property
    def archives(self) -> Path:
        """The archives of submissions, each named by its SHA-256 and its suffix."""
        return self.files / "archives"

    @property
    def live(self) -> Path:
        """The folder in which the conductor tells of matches that are being played."""
        return self.files / "live"

    def match_folder(self, match: int) -> Path:
        """Return the output folder of a match: its record and logs."""
        # A folder of a hundred thousand entries is slow to list.
        return self.files / "matches" / f"{match // 1000:04d}" / str(match)

    def submission_folder(self, submission: int) -> Path:
        """Return the folder of what was found out about a submission: the logs of its validation."""
        return self.files / "submissions" / str(submission)

    def validation_file(self, submission: int) -> Path:
        """Return the file in which a validation that runs tells in one line how far it is."""
        return self.submission_folder(submission) / "validation.txt"

    def track(self, name: str) -> TrackSettings:
        """Return the settings of a track.

        Raises:
            SettingsError: The season does not have it.
        """
        if name not in self.settings.tracks:
            tracks = ", ".join(self.settings.tracks)
            raise SettingsError(f"the season has no track {name!r}; it has {tracks}")
        return self.settings.tracks[name]

    def suite(self, track: str) -> Suite:
        """Return the suite of a track.

        Raises:
            UserError: There is none of that name, or its file cannot be read.
        """
        if track in self.editions:
            return self.editions[track].suite()
        name = self.track(track).suite
        return read_suite(self.folder / name) if name.endswith(SUFFIX) else find_suite(name)

    @cached_property
    def suite_matches(self) -> dict[str, tuple[MatchSpec, ...]]:
        """The matches of each track in mode suite, which are the same for every submission."""
        return self._matches_of_suites(self.seed)

    @cached_property
    def final_matches(self) -> dict[str, tuple[MatchSpec, ...]]:
        """The matches of each track in mode suite that decide the season."""
        return self._matches_of_suites(self.final_seed)

    def _matches_of_suites(self, seed: SuiteSeed) -> dict[str, tuple[MatchSpec, ...]]:
        return {
            name: matches_in_rounds(self.suite(name), name, seed.value, track.rounds)
            for name, track in self.settings.tracks.items()
            if track.mode == "suite"
        }

    def limits(self, track: str) -> Limits:
        """Return the limits of an agent on a track."""
        limits, wall_clock = self.suite(track).limits.get(track, DEFAULT_LIMITS), self.track(track).wall_clock
        return limits if wall_clock is None else limits.model_copy(update={"wall_clock": wall_clock})

    def clock(self, track: str) -> Clock:
        """Return the limits of agents' time on a track, to be fitted to each match."""
        return Clock(longest=self.limits(track).wall_clock)

    def bound(self, track: str) -> float:
        """Return how long agents can make a match of a track last, s.

        Raises:
            ValueError: The budgets of its steps alone exceed its longest time.
        """
        settings, matches = self.track(track), self.suite(track).matches(track, self.seed.value)
        if settings.mode == "ladder":  # its seats are of the season, and submissions may fill all of them
            seats = (SUBMISSION,) * settings.seats
            matches = tuple(spec.model_copy(update={"seats": seats}) for spec in matches)
        return max(map(self.clock(track).bound, matches))
