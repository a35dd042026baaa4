"""Databases of older versions are brought up to date and lose nothing."""

import contextlib
import sqlite3
from collections.abc import Callable
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from sqlalchemy import select

from wildscav.errors import UserError
from wildscav_evaluator.output.results import Results
from wildscav_leaderboard.results.database import reading
from wildscav_leaderboard.results.models import Base, Evaluation
from wildscav_leaderboard.results.sink import DatabaseSink
from wildscav_leaderboard.results.standings import standings

Make = Callable[..., Results]

# As it was written before databases named their version.
UNNUMBERED = """
CREATE TABLE submissions (
    id INTEGER NOT NULL, name VARCHAR NOT NULL, version VARCHAR NOT NULL, digest VARCHAR NOT NULL,
    PRIMARY KEY (id), UNIQUE (name, version, digest)
);
CREATE INDEX ix_submissions_name ON submissions (name);
CREATE TABLE evaluations (
    id INTEGER NOT NULL, submission_id INTEGER NOT NULL, track VARCHAR NOT NULL, suite VARCHAR NOT NULL,
    seed VARCHAR NOT NULL, engine_version VARCHAR NOT NULL, started DATETIME NOT NULL,
    faults INTEGER NOT NULL,
    PRIMARY KEY (id), UNIQUE (submission_id, track, suite, seed, engine_version),
    FOREIGN KEY(submission_id) REFERENCES submissions (id)
);
CREATE TABLE scores (
    evaluation_id INTEGER NOT NULL, position INTEGER NOT NULL, name VARCHAR NOT NULL, title VARCHAR NOT NULL,
    unit VARCHAR NOT NULL, lower_is_better BOOLEAN NOT NULL, mean DOUBLE NOT NULL, std DOUBLE,
    low DOUBLE NOT NULL, high DOUBLE NOT NULL,
    PRIMARY KEY (evaluation_id, position), FOREIGN KEY(evaluation_id) REFERENCES evaluations (id)
);
CREATE TABLE match_results (
    evaluation_id INTEGER NOT NULL, "index" INTEGER NOT NULL, status VARCHAR NOT NULL, fault VARCHAR,
    detail VARCHAR NOT NULL, metrics JSON,
    PRIMARY KEY (evaluation_id, "index"), FOREIGN KEY(evaluation_id) REFERENCES evaluations (id)
);
INSERT INTO submissions VALUES(1, 'homing', '1.0.0', 'digest of homing 1.0.0');
INSERT INTO evaluations VALUES(
    1, 1, 'navigation', 'quick', '0', '0.1.0', '2030-01-01 00:00:00.000000', 0
);
INSERT INTO scores VALUES(1, 0, 'time', 'used + punish time', 's', 1, 9.0, NULL, 9.0, 9.0);
INSERT INTO match_results VALUES(1, 0, 'finished', NULL, '', '{"time": 9.0}');
"""


@pytest.fixture
def old(tmp_path: Path) -> Path:
    path = tmp_path / "wildscav.db"
    execute(path, UNNUMBERED)
    return path


def execute(path: Path, script: str) -> None:
    with contextlib.closing(sqlite3.connect(path)) as connection:
        connection.executescript(script)


def test_a_new_database_has_the_tables_that_the_models_describe(make_results: Make, tmp_path: Path) -> None:
    path = tmp_path / "wildscav.db"
    DatabaseSink(str(path)).store(make_results({("homing", "navigation"): [1.0]}))

    with reading(path) as session:
        context = MigrationContext.configure(session.connection())
        assert compare_metadata(context, Base.metadata) == []


def test_an_old_database_is_read_with_all_that_it_holds(old: Path) -> None:
    with reading(old) as session:
        context = MigrationContext.configure(session.connection())
        assert compare_metadata(context, Base.metadata) == []
        (only,) = standings(session)
        assert (only.track, only.sandbox, only.limits) == ("navigation", "unknown", "{}")
        # Of which nobody knows what it can be compared with: it stands alone.
        assert (only.simulation_version, only.generator_version, only.record_version) == (0, 0, 0)
        assert only.rows[0].evaluation.key is None
        (row,) = only.rows
        assert (row.rank, row.evaluation.submission.name) == (1, "homing")
        assert [score.mean for score in row.evaluation.scores] == [9.0]
        assert [match.metrics for match in row.evaluation.matches] == [{"time": 9.0}]


def test_an_old_evaluation_is_not_taken_for_one_in_a_known_sandbox(make_results: Make, old: Path) -> None:
    DatabaseSink(str(old)).store(make_results({("homing", "navigation"): [1.0]}))

    with reading(old) as session:
        assert {one.sandbox: len(one.matches) for one in session.scalars(select(Evaluation))} == {
            "unknown": 1,
            "process": 1,
        }


def test_a_check_leaves_an_old_database_as_it_was(old: Path) -> None:
    before = old.read_bytes()

    DatabaseSink(str(old)).check()

    assert old.read_bytes() == before


def test_a_database_of_a_version_to_come_is_refused(make_results: Make, old: Path) -> None:
    execute(
        old,
        "CREATE TABLE alembic_version (version_num VARCHAR(32)); INSERT INTO alembic_version VALUES('99')",
    )
    before = old.read_bytes()

    with pytest.raises(UserError, match="was written by a newer version of Wildscav"), reading(old):
        pass
    with pytest.raises(UserError, match="was written by a newer version of Wildscav"):
        DatabaseSink(str(old)).store(make_results({("homing", "navigation"): [1.0]}))

    assert old.read_bytes() == before
