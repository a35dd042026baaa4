"""Scores from records alone: what an evaluation says holds only if its records bear it out."""

import re
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from tests.evaluator.results_by_hand import MODEL

from wildscav.errors import UserError
from wildscav_evaluator.cli.sessions.rescore import recomputed, run_rescore
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.output.identity import read_identity
from wildscav_evaluator.output.record_names import record_paths
from wildscav_evaluator.output.results import Evaluation, Results, read_results, write_results
from wildscav_evaluator.scores.expected_matches import expected_matches, judge_of
from wildscav_evaluator.scores.rescore import Replayed, disagreements, read_file, recompute, replay_file

Faults = Callable[[Sequence[Replayed], Results], list[str]]


@pytest.fixture(scope="module")
def replayed(evaluated: Path) -> list[Replayed]:
    """Its records, played again: five of ada's, and five of bob's."""
    return [replay(path) for path in record_paths(evaluated)]


def replay(path: Path) -> Replayed:
    return replay_file(read_file(path))


@pytest.fixture
def told(evaluated: Path) -> Results:
    return read_results(evaluated / "results.json")


@pytest.fixture
def faults(evaluated: Path) -> Faults:
    """Say in what records and results disagree."""

    def compared(replayed: Sequence[Replayed], told: Results) -> list[str]:
        judge = judge_of(evaluated, told, expected_matches(evaluated, told))
        return list(disagreements(replayed, told, recompute(replayed, told), judge))

    return compared


def test_every_number_of_an_evaluation_comes_out_again(
    evaluated: Path, replayed: list[Replayed], told: Results, faults: Faults
) -> None:
    assert recomputed(evaluated, replayed, told) == told
    assert recomputed(evaluated, replayed, told.model_copy(update={"overall": ()})) == told
    identity = read_identity(evaluated)
    assert identity is not None
    asked = identity.model_copy(update={"model": MODEL})
    assert recomputed(evaluated, replayed, None, asked).model == MODEL, "of an evaluation without results yet"
    assert faults(replayed, told) == []


def test_tables_come_from_the_records_alone(replayed: list[Replayed], told: Results) -> None:
    for found, before in zip(recompute(replayed, None), told.evaluations, strict=True):
        assert found.summary == before.summary
        assert [row.metrics for row in found.matches] == [row.metrics for row in before.matches]


def with_another_mean(ada: Evaluation) -> Evaluation:
    better = ada.summary["time"].model_copy(update={"mean": 0.5})
    return ada.model_copy(update={"summary": {**ada.summary, "time": better}})


def with_another_time(ada: Evaluation) -> Evaluation:
    first, *others = ada.matches
    quicker = first.model_copy(update={"metrics": {**(first.metrics or {}), "time": 0.5}})
    return ada.model_copy(update={"matches": (quicker, *others)})


@pytest.mark.parametrize(
    ("change", "line"),
    [
        (with_another_mean, r"ada on navigation: time is 0\.5 \(.*its records give "),
        (with_another_time, r"ada on navigation, match 0: the results say time 0\.5, "),
        (
            lambda ada: ada.model_copy(update={"matches": ada.matches[1:]}),
            "ada on navigation, match 0: there is a record, but no result",
        ),
        (
            lambda ada: ada.model_copy(update={"submission": "cy"}),
            "ada on navigation: there are records, but no results",
        ),
    ],
)
def test_results_that_were_changed_are_named(
    replayed: list[Replayed],
    told: Results,
    faults: Faults,
    change: Callable[[Evaluation], Evaluation],
    line: str,
) -> None:
    ada, bob = told.evaluations

    said = faults(replayed, told.model_copy(update={"evaluations": (change(ada), bob)}))

    assert [one for one in said if re.match(line, one)], said
    assert not [one for one in said if "bob" in one]


def test_a_record_that_was_taken_away_or_is_of_another_match_is_named(
    evaluated: Path, replayed: list[Replayed], told: Results, faults: Faults, tmp_path: Path
) -> None:
    name = Path(str(replayed[0].record)).name
    swapped = replay(Path(shutil.copy(evaluated / str(replayed[2].record), tmp_path / name)))  # ada's, too

    assert "ada on navigation, match 0: its record is missing or does not hold" in faults(replayed[1:], told)
    assert f"records/{name}: is not match 0 of the suite" in faults([swapped, *replayed[1:]], told)


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("gathering-000-ada.wsr", "it is of navigation, not of gathering"),
        ("navigation-000-bob.wsr", "seat 0 belongs to ada, not to bob"),
        ("mine.wsr", "it is not named as evaluations name records"),
    ],
)
def test_a_record_under_a_wrong_name_or_that_is_damaged_does_not_count(
    evaluated: Path, tmp_path: Path, name: str, says: str
) -> None:
    record = evaluated / "records" / "navigation-000-ada.wsr"
    shutil.copy(record, tmp_path / name)
    (tmp_path / record.name).write_bytes(record.read_bytes()[:-1])

    found = replay(tmp_path / name)

    assert (found.fault, found.metrics) == (says, None)
    assert "checksum" in replay(tmp_path / record.name).fault


def test_matches_of_a_suite_that_is_not_the_one_played_are_no_measure(told: Results, tmp_path: Path) -> None:
    theirs = told.model_copy(update={"suite": "theirs@12345678"})
    with pytest.raises(UserError, match=r"suite\.toml: No such file"):
        expected_matches(tmp_path, theirs)

    (tmp_path / "suite.toml").write_text('name = "theirs"\ntracks = { navigation = { maps = 1 } }')
    with pytest.raises(UserError, match="but theirs@12345678 was played"):
        expected_matches(tmp_path, theirs)


def test_the_command_shows_the_tables_and_says_whether_all_agree(
    evaluated: Path, tmp_path: Path, told: Results, capsys: pytest.CaptureFixture[str]
) -> None:
    copy = shutil.copytree(evaluated, tmp_path / "out")
    run_rescore(copy, LocalExecutor(1))

    agreed = capsys.readouterr().out
    assert "navigation · suite tiny@" in agreed
    assert "10 records played again: all agree with" in " ".join(agreed.split())
    ada, bob = told.evaluations
    changed = ada.model_copy(update={"summary": {}})
    write_results(told.model_copy(update={"evaluations": (changed, bob)}), copy)
    with pytest.raises(UserError):
        run_rescore(copy, LocalExecutor(1))
    assert "success is missing, its records give" in " ".join(capsys.readouterr().err.split())


def test_records_of_an_evaluation_that_came_to_no_results_yet_are_played_again_all_the_same(
    evaluated: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    copy = shutil.copytree(evaluated, tmp_path / "out")
    (copy / "results.json").unlink()
    lines = (copy / "ledger.jsonl").read_bytes().splitlines(keepends=True)
    (copy / "ledger.jsonl").write_bytes(b"".join(lines[:-1]))  # without the entry of the results

    run_rescore(copy, LocalExecutor(1))
    said = " ".join(capsys.readouterr().out.split())
    assert "navigation · suite tiny@" in said
    assert "played in process; each agent: " in said
    assert "there is no" in said

    (copy / "evaluation.json").unlink()
    run_rescore(copy, LocalExecutor(1))
    assert "navigation · suite unknown · seed unknown" in " ".join(capsys.readouterr().out.split())


def test_a_folder_without_records_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="there are no records in"):
        run_rescore(tmp_path, LocalExecutor(1))
