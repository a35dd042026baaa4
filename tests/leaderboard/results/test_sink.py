"""The sink: every evaluation once, all of it or nothing."""

import contextlib
import sqlite3
import subprocess
import sys
from collections.abc import Callable
from importlib.metadata import entry_points
from pathlib import Path

import pytest
from sqlalchemy import Connection, func, select

from wildscav.errors import UserError
from wildscav_evaluator.output.results import Results
from wildscav_evaluator.result_sinks import GROUP, sinks
from wildscav_leaderboard.results import database
from wildscav_leaderboard.results.database import reading
from wildscav_leaderboard.results.models import Base, Evaluation, MatchResult, Score, Submission
from wildscav_leaderboard.results.sink import DatabaseSink

Make = Callable[..., Results]


def count(path: Path, table: type[Base]) -> int:
    with reading(path) as session:
        return session.scalar(select(func.count()).select_from(table)) or 0


def test_the_sink_plugs_in_by_entry_point(tmp_path: Path) -> None:
    assert {point.name for point in entry_points(group=GROUP)} == {"database"}
    assert [type(sink) for sink in sinks(str(tmp_path / "db"))] == [DatabaseSink]


def test_the_same_evaluation_again_replaces_the_one_before(make_results: Make, tmp_path: Path) -> None:
    path = tmp_path / "new" / "folder" / "wildscav.db"
    sink = DatabaseSink(str(path))

    sink.store(make_results({("homing", "navigation"): [1.0, 2.0]}))
    sink.store(make_results({("homing", "navigation"): [3.0]}))

    assert [count(path, table) for table in (Submission, Evaluation, Score, MatchResult)] == [1, 1, 1, 1]
    with reading(path) as session:
        assert session.scalars(select(Score)).one().mean == 3.0
        assert session.scalars(select(MatchResult)).one().metrics == {"time": 3.0}


def test_other_seeds_versions_and_tracks_are_other_evaluations(make_results: Make, tmp_path: Path) -> None:
    path = tmp_path / "wildscav.db"
    sink = DatabaseSink(str(path))

    sink.store(make_results({("homing", "navigation"): [1.0], ("homing", "gathering"): [5.0]}))
    sink.store(make_results({("homing", "navigation"): [1.0]}, seed=2**70))
    sink.store(make_results({("homing", "navigation"): [1.0]}, version="2.0.0"))

    assert count(path, Submission) == 2
    assert count(path, Evaluation) == 4


def test_another_sandbox_or_limit_makes_another_evaluation(make_results: Make, tmp_path: Path) -> None:
    path = tmp_path / "wildscav.db"
    sink, scores = DatabaseSink(str(path)), {("homing", "navigation"): [1.0]}

    for conditions in ({}, {"sandbox": "oci"}, {"sandbox": "oci", "memory": 2**30}, {"sandbox": "oci"}):
        sink.store(make_results(scores, **conditions))

    with reading(path) as session:
        found = {(one.sandbox, one.limits) for one in session.scalars(select(Evaluation))}
    assert found == {("process", "{}"), ("oci", "{}"), ("oci", '{"memory":1073741824}')}
    assert (count(path, Submission), count(path, Evaluation)) == (1, 3)


def test_a_match_that_came_to_nothing_is_kept_with_its_reason(make_results: Make, tmp_path: Path) -> None:
    path = tmp_path / "wildscav.db"

    DatabaseSink(str(path)).store(make_results({("homing", "navigation"): []}))

    with reading(path) as session:
        row = session.scalars(select(MatchResult)).one()
        assert (row.status, row.fault, row.detail, row.metrics) == ("failed", "platform", "no map", None)


@pytest.mark.parametrize(
    ("prepare", "says"),
    [
        (
            lambda path: path.write_text("no database at all, but long enough to be read as one " * 9),
            "is not a",
        ),
        (lambda path: path.mkdir(), "cannot be used"),
    ],
)
def test_what_cannot_be_written_is_one_clear_line(
    make_results: Make, tmp_path: Path, prepare: Callable[[Path], object], says: str
) -> None:
    path = tmp_path / "wildscav.db"
    prepare(path)

    with pytest.raises(UserError, match=says) as caught:
        DatabaseSink(str(path)).store(make_results({("homing", "navigation"): [1.0]}))

    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def foreign(path: Path) -> None:
    with contextlib.closing(sqlite3.connect(path)) as connection:
        connection.execute("CREATE TABLE recipes (name TEXT)")
        connection.commit()


@pytest.mark.parametrize("use", ["check", "store"])
def test_a_strangers_database_is_refused_and_stays_as_it_is(
    make_results: Make, tmp_path: Path, use: str
) -> None:
    path = tmp_path / "recipes.db"
    foreign(path)
    before = path.read_bytes()
    sink = DatabaseSink(str(path))

    with pytest.raises(UserError, match="is a database, but not a leaderboard's"):
        sink.check() if use == "check" else sink.store(make_results({("homing", "navigation"): [1.0]}))

    assert path.read_bytes() == before


def test_a_check_leaves_nothing_new_behind_and_nothing_old_changed(
    make_results: Make, tmp_path: Path
) -> None:
    path = tmp_path / "new" / "folder" / "wildscav.db"
    sink = DatabaseSink(str(path))

    sink.check()
    assert list(tmp_path.iterdir()) == []

    assert sink.store(make_results({("homing", "navigation"): [1.0]})).startswith("1 evaluation is in")
    before = path.read_bytes()
    sink.check()
    assert path.read_bytes() == before
    assert list(path.parent.iterdir()) == [path]


def test_a_check_leaves_alone_what_another_command_stores_meanwhile(
    make_results: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "out" / "wildscav.db"
    sink = DatabaseSink(str(path))

    def store_meanwhile(connection: Connection) -> None:
        monkeypatch.undo()
        sink.store(make_results({("homing", "navigation"): [1.0]}))
        database.bring_up_to_date(connection)

    monkeypatch.setattr(database, "bring_up_to_date", store_meanwhile)
    sink.check()

    assert count(path, Evaluation) == 1


def test_a_full_disk_leaves_no_empty_database(tmp_path: Path) -> None:
    path = tmp_path / "wildscav.db"
    code = f"from wildscav_leaderboard.results.sink import DatabaseSink; DatabaseSink({str(path)!r}).check()"
    # Nothing beyond 512 or 1024 bytes can be written: as on a full disk, writes fail.
    command = ["sh", "-c", 'ulimit -f 1 && exec "$@"', "sh", sys.executable, "-c", code]

    done = subprocess.run(command, capture_output=True, text=True, timeout=300)

    assert "cannot be used" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_made_is_one_clear_line(make_results: Make) -> None:
    with pytest.raises(UserError, match="cannot make the folder of the database /dev/null/db"):
        DatabaseSink("/dev/null/db/wildscav.db").store(make_results({("homing", "navigation"): [1.0]}))
