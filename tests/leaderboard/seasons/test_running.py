"""A season that runs: its database, its disk while that is nearly full, and its threads."""

import threading
from pathlib import Path

import pytest
from sqlalchemy import create_engine
from tests.leaderboard.hosting.clients import serving
from tests.leaderboard.seasons_made import NOON, changed, make_season, team_with_member
from tests.leaderboard.seasons_made import opened as make_tables

from wildscav.errors import UserError
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_leaderboard.access.uploads import check_upload_wanted
from wildscav_leaderboard.cli.season.folders import backup
from wildscav_leaderboard.cli.season.running import status
from wildscav_leaderboard.conductor.conductor import Conductor
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.database.schema import take_back_to, version_of
from wildscav_leaderboard.organizing.backups.restore import restore
from wildscav_leaderboard.organizing.checking import check_rules, check_season
from wildscav_leaderboard.seasons import disk, watchdog
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.own_database import opened
from wildscav_leaderboard.seasons.refusals import UnavailableError
from wildscav_leaderboard.seasons.state import RESTARTS, SEASON, read_state

VARIABLE = "WILDSCAV_SEASON_DATABASE"


@pytest.fixture
def season(tmp_path: Path, empty_url: str, monkeypatch: pytest.MonkeyPatch) -> Season:
    """A season on a database of each kind."""
    monkeypatch.setenv(VARIABLE, empty_url)
    made = make_season(tmp_path / "season", current=True)
    with opened(made):
        return made


@pytest.fixture
def old_version(season: Season) -> str:
    """The version of the season's database, which is the one before the current one."""
    engine = create_engine(season.database().url)
    with engine.begin() as connection:
        take_back_to(connection, "-1")
    engine.dispose()
    return version(season)


def version(season: Season) -> str:
    engine = create_engine(season.database().url)
    with engine.connect() as connection:
        found = version_of(connection)
    engine.dispose()
    assert found is not None
    return found


def test_the_database_of_another_season_is_refused(season: Season, tmp_path: Path) -> None:
    other = make_season(tmp_path / "other", current=True)
    with pytest.raises(UserError, match="is of another season, trial, whose secret is not the one in"):
        status(other.folder)
    with opened(season) as database, database.reading() as session:
        assert read_state(session, SEASON) == {"name": "trial", "commitment": season.seed.commitment}


def test_an_older_database_is_backed_up_as_it_is(season: Season, old_version: str, tmp_path: Path) -> None:
    backup(season.folder, tmp_path / "old.tar")
    with pytest.raises(UserError, match="`wildscav season serve` brings it up to date"):
        status(season.folder)
    assert version(season) == old_version


def test_a_season_that_begins_to_run_upgrades_its_database_after_a_backup(
    season: Season, old_version: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second, *_ = check_rules(season)

    (backed_up,) = (season.folder / "backups").iterdir()
    assert str(backed_up) in first
    assert f"schema {old_version}" in first
    assert f"brought to schema {version(season)}" in second
    assert version(season) != old_version
    assert not any("schema" in line for line in check_rules(season))  # it is up to date
    backup(season.folder, tmp_path / "new.tar")  # which does not hold the first one
    assert (tmp_path / "new.tar").stat().st_size < 2 * backed_up.stat().st_size
    monkeypatch.delenv(VARIABLE)
    restore(backed_up, tmp_path / "again")
    assert not [one for one in check_season(tmp_path / "again").problems if "commitments" not in one]


def test_other_users_can_read_nothing_of_a_season(tmp_path: Path) -> None:
    season = make_season(tmp_path / "season", current=True)
    season.files.mkdir()
    file = tmp_path / "elsewhere.db"
    season = changed(season, database=f"sqlite:///{file}")
    season.database().upgrade()
    for path, mode in ((season.folder, 0o755), (season.files, 0o775), (file, 0o644)):
        path.chmod(mode)

    with opened(season):
        pass

    closed = (season.folder, season.files, file, *season.folder.iterdir())
    assert [oct(path.stat().st_mode & 0o077) for path in closed] == ["0o0"] * len(closed)


FULL = r"the disk of the season has [\d.]+ GiB left: nothing new is begun"


def test_nothing_is_taken_in_or_begun_while_the_disk_is_nearly_full(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    season = make_season(tmp_path / "season")
    with make_tables(season) as database:
        with database.writing() as session:
            _, captain = team_with_member(session, "foxes")
        monkeypatch.setattr(disk, "FLOOR", 1 << 60)
        with pytest.raises(UnavailableError, match=FULL):
            check_upload_wanted(database, season, captain, NOON)
        with pytest.raises(UnavailableError, match=FULL), LocalExecutor(1) as executor:
            Conductor(season, database).round(executor)
        with serving(season, database) as (_, client):
            answer = client.get("/ready")
            assert (answer.status_code, "the disk of the season" in answer.json()["reason"]) == (503, True)
            assert client.get("/").status_code == 200  # what is there is shown


def test_work_that_breaks_is_begun_again_and_counted(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(watchdog, "PAUSE", 0.0)
    ended, begun = threading.Event(), []

    def work() -> None:
        begun.append(1)
        if len(begun) < 3:
            raise OverflowError("getsockaddrarg: port must be 0-65535")
        ended.set()

    thread = watchdog.watched_thread("webhooks", work, ended, database)
    thread.start()
    thread.join()

    assert len(begun) == 3
    with database.reading() as session:
        assert read_state(session, RESTARTS) == {"webhooks": 2}
