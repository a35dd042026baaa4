"""`wildscav leaderboard` as its user runs it."""

import json
import sqlite3
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.commands import run_command

from wildscav_evaluator.output.results import Results
from wildscav_leaderboard.results.sink import DatabaseSink

Make = Callable[..., Results]


def leaderboard(*arguments: object) -> "subprocess.CompletedProcess[str]":
    return run_command("leaderboard", *arguments)


def test_it_prints_a_table_for_every_track(make_results: Make, tmp_path: Path) -> None:
    path = tmp_path / "wildscav.db"
    scores = {
        ("homing", "gathering"): [12.0],
        ("hunter", "gathering"): [30.5],
        ("homing", "navigation"): [9.0],
    }
    DatabaseSink(str(path)).store(make_results(scores))

    done = leaderboard("--db", path)

    assert done.returncode == 0, done.stderr
    navigation, gathering = done.stdout.split("gathering ·")
    lines = [line.split() for line in gathering.splitlines()]
    assert [line[:4] for line in lines if line[1:2] in (["hunter"], ["homing"])] == [
        ["1", "hunter", "1.0.0", "30.5"],
        ["2", "homing", "1.0.0", "12.0"],
    ]
    assert "9.0" in navigation
    assert "hunter" in leaderboard("--db", path, "--track", "gathering").stdout


def test_it_says_what_the_agents_of_each_table_ran_in(make_results: Make, tmp_path: Path) -> None:
    path = tmp_path / "wildscav.db"
    sink, scores = DatabaseSink(str(path)), {("homing", "gathering"): [12.0]}
    sink.store(make_results(scores))
    sink.store(make_results(scores, sandbox="bubblewrap", memory=2**31))

    said = leaderboard("--db", path).stdout

    assert said.count("gathering · suite quick · seed 0") == 2
    assert "played in process\n" in said
    assert "played in bubblewrap; each agent: 2 GiB of memory\n" in said


def test_it_says_which_versions_played_and_who_signed(make_results: Make, tmp_path: Path) -> None:
    path = tmp_path / "wildscav.db"
    sink = DatabaseSink(str(path))
    sink.store(make_results({("homing", "gathering"): [12.0]}, key="ab" * 32))
    sink.store(make_results({("hunter", "gathering"): [9.0]}))

    said = leaderboard("--db", path).stdout

    assert "played by engine 0.1.0, simulation 2, generator 3, records 2\n" in said
    assert f"signed: homing with the key {'ab' * 32}\n" in said
    (table,) = json.loads(leaderboard("--db", path, "--json").stdout)["standings"]
    assert (table["track"], table["simulation_version"]) == ("gathering", 2)
    assert {row["submission"]: row["key"] for row in table["rows"]} == {"homing": "ab" * 32, "hunter": None}


def empty(path: Path) -> None:
    sqlite3.connect(path).close()
    path.touch()


@pytest.mark.parametrize(
    ("prepare", "code", "says"),
    [
        (lambda _: None, 2, "there is no database"),
        (empty, 2, "not a leaderboard's"),
        (lambda path: path.write_text("a letter " * 200), 1, "is not a leaderboard's database"),
    ],
)
def test_what_is_no_leaderboard_is_one_clear_line(
    tmp_path: Path, prepare: Callable[[Path], object], code: int, says: str
) -> None:
    path = tmp_path / "wildscav.db"
    prepare(path)

    done = leaderboard("--db", path)

    assert done.returncode == code
    assert done.stderr.startswith("wildscav: ")
    assert says in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_a_track_without_evaluations_is_one_clear_line(make_results: Make, tmp_path: Path) -> None:
    path = tmp_path / "wildscav.db"
    DatabaseSink(str(path)).store(make_results({("homing", "gathering"): [12.0]}))

    done = leaderboard("--db", path, "--track", "battle")

    assert done.returncode == 1
    assert "there are no evaluations of track battle in" in done.stderr


def test_a_suite_or_a_track_is_found_by_the_beginning_of_its_name(make_results: Make, tmp_path: Path) -> None:
    path = tmp_path / "wildscav.db"
    results = make_results({("homing", "gathering"): [12.0]})
    DatabaseSink(str(path)).store(results.model_copy(update={"suite": "spring@19da5d55"}))

    for option in ("--suite=spring", "--track=gath"):
        assert "suite spring@19da5d55" in leaderboard("--db", path, option).stdout
    assert leaderboard("--db", path, "--suite=summer").returncode == 1
