"""`wildscav leaderboard` as its user runs it."""

import json
from functools import partial
from pathlib import Path

import pytest
from tests.commands import run_command
from tests.evaluator.results_by_hand import saved, scored_results

from wildscav_evaluator.output.results import CURRENT_VERSIONS

leaderboard = partial(run_command, "leaderboard")


def test_it_prints_a_table_for_every_track(tmp_path: Path) -> None:
    saved(scored_results({("homing", "gathering"): [12.0]}, key="ab" * 32), tmp_path / "1")
    scores = {("hunter", "gathering"): [30.5], ("homing", "navigation"): [9.0]}
    saved(scored_results(scores), tmp_path / "2")

    done = leaderboard(tmp_path)

    assert done.returncode == 0, done.stderr
    navigation, gathering = done.stdout.split("gathering ·")
    lines = [line.split() for line in gathering.splitlines()]
    assert [line[:4] for line in lines if line[2:3] == ["1.0.0"] and line[0].isdecimal()] == [
        ["1", "hunter", "1.0.0", "30.5"],
        ["2", "homing", "1.0.0", "12.0"],
    ]
    assert "9.0" in navigation
    assert f"played by {CURRENT_VERSIONS}\n" in gathering
    assert "started: all on 2030-01-01\n" in gathering
    assert f"signed: homing 1.0.0 with the key {'ab' * 32}\n" in gathering
    (table,) = json.loads(leaderboard(tmp_path, "--track=gath", "--json").stdout)["standings"]
    assert (table["track"], table["simulation_version"]) == ("gathering", CURRENT_VERSIONS.simulation)
    assert {row["submission"]: row["key"] for row in table["rows"]} == {"homing": "ab" * 32, "hunter": None}


def test_it_says_when_each_row_was_played(tmp_path: Path) -> None:
    by_words = scored_results({("homing", "gathering"): [12.0]}, started="2030-01-02T00:00:00+00:00")
    one = by_words.evaluations[0].model_copy(update={"interface": "words"})
    saved(by_words.model_copy(update={"evaluations": (one,)}), tmp_path / "1")
    saved(scored_results({("homing", "gathering"): [30.5]}), tmp_path / "2")

    said = leaderboard(tmp_path).stdout

    assert "started: homing 1.0.0 on 2030-01-01; homing 1.0.0 (words) on 2030-01-02\n" in said


def test_it_says_what_the_agents_of_each_table_ran_in(tmp_path: Path) -> None:
    scores = {("homing", "gathering"): [12.0]}
    one = saved(scored_results(scores), tmp_path / "1")
    other = saved(scored_results(scores, sandbox="bubblewrap", memory=2**31), tmp_path / "2")

    said = leaderboard(one, other).stdout

    assert said.count("gathering · suite quick · seed 0") == 2
    assert "played in process\n" in said
    assert "played in bubblewrap; each agent: 2 GiB of memory\n" in said


def test_a_suite_is_found_by_the_beginning_of_its_name(tmp_path: Path) -> None:
    saved(scored_results({("homing", "gathering"): [12.0]}, suite="spring@19da5d55"), tmp_path / "1")

    assert "suite spring@19da5d55" in leaderboard(tmp_path, "--suite=spring").stdout
    assert leaderboard(tmp_path, "--suite=summer").returncode == 1


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (["{out}/nowhere"], 2, "nowhere does not exist"),
        (["{out}/empty"], 1, "there are no evaluations in "),
        (["{out}/letter.txt"], 1, "is not a results file"),
        (["{out}/1", "--track=battle"], 1, "there are no evaluations of track battle in "),
        (["{out}/1", "--season", "{out}/1"], 2, "leave out the folders"),
    ],
)
def test_what_is_no_leaderboard_is_one_clear_line(
    tmp_path: Path, arguments: list[str], code: int, says: str
) -> None:
    saved(scored_results({("homing", "gathering"): [12.0]}), tmp_path / "1")
    (tmp_path / "empty").mkdir()
    (tmp_path / "letter.txt").write_text("a letter")

    done = leaderboard(*(text.format(out=tmp_path) for text in arguments))

    assert done.returncode == code
    (line,) = done.stderr.splitlines()
    assert line.startswith("wildscav: ")
    assert says in line


def test_the_old_option_of_a_database_says_what_replaced_it(tmp_path: Path) -> None:
    saved(scored_results({("homing", "gathering"): [12.0]}), tmp_path / "1")

    done = leaderboard(tmp_path, "--db", tmp_path / "wildscav.db")

    assert done.returncode == 0
    (line,) = done.stderr.splitlines()
    assert line.startswith("--db has no effect")
