"""A backup brings everything back, on the same kind of database or another, or it brings nothing."""

import os
import tarfile
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest
from sqlalchemy import MetaData, create_engine, select
from tests.leaderboard.agents import write_agent
from tests.leaderboard.postgresql import PostgreSQL
from tests.leaderboard.results_made import made_result
from tests.leaderboard.seasons_made import (
    NOON,
    make_account,
    make_season,
    opened,
    submitted,
    team_with_member,
)

from wildscav.errors import UserError
from wildscav_evaluator.output.results import metric_infos
from wildscav_leaderboard.conductor.plans import plan_suites
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import MatchResult
from wildscav_leaderboard.matches.service import PlayedRecord, deliver, next_matches, seats_of
from wildscav_leaderboard.organizing.acts import announce
from wildscav_leaderboard.organizing.backups.archive import SUMS
from wildscav_leaderboard.organizing.backups.backup import back_up
from wildscav_leaderboard.organizing.backups.restore import restore
from wildscav_leaderboard.organizing.checking import check_season
from wildscav_leaderboard.seasons.acts import Doing
from wildscav_leaderboard.seasons.folder import SECRET_FILE, Season
from wildscav_leaderboard.seasons.initial_files import COMMITMENTS_FILE, commitments_text
from wildscav_leaderboard.submissions.service import list_submissions

RECORD = b"what was played"
DIGEST = "927715ebc346499569437b5301048e17"  # BLAKE2b of these bytes, 16 bytes
VARIABLE = "WILDSCAV_SEASON_DATABASE"


@pytest.fixture
def season(tmp_path: Path, empty_url: str, monkeypatch: pytest.MonkeyPatch) -> Season:
    """A season with something in it, on a database of each kind."""
    monkeypatch.setenv(VARIABLE, empty_url)
    return filled_season(tmp_path)


@pytest.fixture
def embedded(tmp_path: Path) -> Season:
    """A season with something in it, whose database is in its folder."""
    return filled_season(tmp_path)


def filled_season(tmp_path: Path) -> Season:
    """Make a season with an announcement, a submission, and the result of a match."""
    season = make_season(tmp_path / "season")
    secrets = [(season.folder / name).read_bytes() for name in (SECRET_FILE, "final-secret.txt")]
    (season.folder / COMMITMENTS_FILE).write_text(commitments_text(*secrets))
    with opened(season) as database, database.writing() as session:
        team_with_member(session, "foxes")
        announce(Doing(session, season, "anna", NOON), "Welcome", "with “quotes”,\nlines and a \\ in it")
        one = submitted(session, season, "foxes", write_agent(tmp_path, "walker"))
        one.playing = one.tracks
        plan_suites(session, season, one, NOON)
        (match,) = next_matches(session, {"navigation": None}, 1)
        seats = seats_of(session, [match.id])[match.id]
        row, timing, _ = made_result(match, seats, [0.1 + 0.2])
        played = PlayedRecord(DIGEST, len(RECORD))
        deliver(session, match, None, row, timing, played, metric_infos("navigation")[0], NOON)
        path = season.match_folder(match.id) / str(row.record)
    path.parent.mkdir(parents=True)
    path.write_bytes(RECORD)
    return season


def content(season: Season) -> dict[str, list[tuple[object, ...]]]:
    """Every row of every table."""
    engine = create_engine(season.database().url)
    tables = MetaData()
    with engine.connect() as connection:
        tables.reflect(connection)
        found = {
            table.name: [tuple(row) for row in connection.execute(select(table).order_by(*table.primary_key))]
            for table in tables.sorted_tables
        }
    engine.dispose()
    return found


@contextmanager
def refused(says: str, out: Path) -> Iterator[None]:
    """Check that a backup is not restored, and leaves nothing."""
    with pytest.raises(UserError, match=says):
        yield
    assert not out.exists()


def backed_up(season: Season, out: Path) -> Path:
    with closing(season.database()) as database:
        back_up(season, database, out, NOON)
    return out


def files(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and not path.name.startswith("season.db") and "uploads" not in path.parts
    }


def test_everything_comes_back(season: Season, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = content(season)
    out = backed_up(season, tmp_path / "backup.tar")
    assert out.stat().st_mode & 0o777 == 0o600
    monkeypatch.delenv(VARIABLE)

    done = restore(out, tmp_path / "restored")

    again = Season.open(tmp_path / "restored")
    assert content(again) == before
    assert done.rows == sum(len(rows) for name, rows in before.items() if name != "season_version")
    assert files(again.folder) == files(season.folder)
    assert (again.folder / SECRET_FILE).stat().st_mode & 0o777 == 0o600
    assert check_season(again.folder).problems == []


def test_a_season_moves_to_postgresql_and_goes_on_counting(
    season: Season, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, postgresql: PostgreSQL
) -> None:
    out = backed_up(season, tmp_path / "backup.tar")
    monkeypatch.setenv(VARIABLE, postgresql.new_database())
    restore(out, tmp_path / "restored")

    again = Season.open(tmp_path / "restored")
    database = again.database()
    with database.writing() as session:
        (one,) = list_submissions(session)
        assert one.created == NOON
        (result,) = session.scalars(select(MatchResult))
        assert result.row["metrics"]["time"] == 0.1 + 0.2
        assert make_account(session, "newcomer").id == 2
    database.close()
    assert check_season(again.folder).problems == []


def test_a_database_with_something_in_it_is_left_alone(season: Season, tmp_path: Path) -> None:
    out = backed_up(season, tmp_path / "backup.tar")
    before = content(season)
    with pytest.raises(UserError, match="is not empty: name a new one"):
        restore(out, tmp_path / "restored")
    assert content(season) == before
    assert not (tmp_path / "restored").exists()


def test_a_backup_is_never_overwritten_and_nothing_half_written_is_left(
    embedded: Season, tmp_path: Path
) -> None:
    out = backed_up(embedded, tmp_path / "backup.tar")
    content = out.read_bytes()
    with pytest.raises(UserError, match="exists already"):
        backed_up(embedded, out)
    with pytest.raises(UserError, match="cannot be written"):
        backed_up(embedded, tmp_path / "nowhere" / "backup.tar")
    with pytest.raises(UserError, match="not an empty folder"):
        restore(out, embedded.folder)
    assert out.read_bytes() == content
    assert [path.name for path in tmp_path.glob(".*")] == []


@pytest.mark.parametrize("name", ["database/match_results.ndjson", "season/secret.txt", SUMS])
def test_a_backup_with_one_wrong_byte_is_refused(embedded: Season, tmp_path: Path, name: str) -> None:
    out = backed_up(embedded, tmp_path / "backup.tar")
    with tarfile.open(out) as tar:
        place = tar.getmember(name).offset_data + 30
    content = bytearray(out.read_bytes())
    content[place] ^= 1
    out.write_bytes(content)
    with refused(r"is damaged: \S+ is not what was backed up", tmp_path / "restored"):
        restore(out, tmp_path / "restored")


def test_a_backup_whose_end_is_missing_is_refused(embedded: Season, tmp_path: Path) -> None:
    out = backed_up(embedded, tmp_path / "backup.tar")
    with tarfile.open(out) as tar:
        end = max(member.offset_data + member.size for member in tar)
    for part in (0.99, 0.9, 0.3):
        os.truncate(out, int(part * end))
        with refused("no backup of a season|damaged", tmp_path / "restored"):
            restore(out, tmp_path / "restored")


@pytest.mark.parametrize("name", ["../outside", "/absolute/outside", "season/../../outside"])
def test_a_tar_that_would_write_elsewhere_is_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / "file").write_text("x")
    with tarfile.open(tmp_path / "evil.tar", "w") as tar:
        tar.add(tmp_path / "file", name)
        tar.getmembers()[0].name = name
    with refused("is no backup of a season", tmp_path / "outside"):
        restore(tmp_path / "evil.tar", tmp_path / "new")


def test_a_missing_file_does_not_stop_a_backup_and_is_named(embedded: Season, tmp_path: Path) -> None:
    (archive,) = embedded.archives.iterdir()
    archive.unlink()
    with closing(embedded.database()) as database:
        done = back_up(embedded, database, tmp_path / "backup.tar", NOON)
    assert done.missing == (str(archive),)


def test_a_check_names_every_file_that_is_missing_or_changed(embedded: Season) -> None:
    assert check_season(embedded.folder).problems == []
    (archive,) = embedded.archives.iterdir()
    (record,) = embedded.files.glob("matches/*/*/records/*")
    record.write_bytes(RECORD[::-1])
    archive.unlink()

    (embedded.folder / SECRET_FILE).write_text("another secret, which is long enough to be one\n")

    found = check_season(embedded.folder)
    assert found.problems.pop(0).startswith("the secrets do not have the commitments in ")
    assert found.files == 2
    assert set(found.longest) == set(embedded.settings.tracks)
    assert found.problems == [
        f"the archive of submission 1 is missing: {archive}",
        f"the record of match 1 was changed: {record}",
    ]


def test_a_check_makes_no_database_and_misses_none_before_the_first_serve(tmp_path: Path) -> None:
    season = make_season(tmp_path / "season")
    before = set(season.folder.iterdir())
    found = check_season(season.folder)
    assert "`wildscav season serve` makes it" in found.note
    assert not any("no database" in problem for problem in found.problems)
    assert set(season.folder.iterdir()) == before

    season.files.mkdir()  # as of a season that ran
    assert any("there is no database" in problem for problem in check_season(season.folder).problems)


def test_a_check_of_a_database_without_a_season_says_so(
    tmp_path: Path, empty_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(VARIABLE, empty_url)
    season = make_season(tmp_path / "season")
    with closing(Database(empty_url)) as database:
        database.check()
    problems = check_season(season.folder).problems
    assert any("has no season of this version" in problem for problem in problems)
