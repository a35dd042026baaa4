"""Scores from records alone: what an evaluation says holds only if its records bear it out."""

import shutil
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from tests.evaluator.results_by_hand import MODEL, plan_of
from tests.evaluator.warm_workers import WarmWorkers, playing_with

from wildscav.errors import UserError
from wildscav_evaluator.cli.sessions.evaluate import run_session
from wildscav_evaluator.cli.sessions.rescore import recomputed, run_rescore
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.output.identity import read_identity
from wildscav_evaluator.output.record_names import record_paths
from wildscav_evaluator.output.results import Evaluation, Results, read_results, write_results
from wildscav_evaluator.scores.expected_matches import expected_matches, judge_of
from wildscav_evaluator.scores.rescore import Replayed, disagreements, recompute, replay_one
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_evaluator.suites.suite_file import read_suite

HOMING = Path(__file__).parents[3] / "submissions" / "homing"
Faults = Callable[[Sequence[Replayed], Results], str]
# Short matches on small maps.
SUITE = """
name = "tiny"
map = { size = 40, houses = 0 }
[tracks.navigation]
maps = 5
match = { time_limit = 3.0 }
"""


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory, warm_workers: WarmWorkers) -> Path:
    """The output folder of an evaluation."""
    folder = tmp_path_factory.mktemp("evaluation")
    (folder / "tiny.toml").write_text(SUITE)
    suite = read_suite(folder / "tiny.toml")
    with playing_with(warm_workers):
        run_session(plan_of(load_submission(HOMING), out=folder / "out", suite=suite))
    return folder / "out"


@pytest.fixture(scope="module")
def replayed(out: Path) -> list[Replayed]:
    return [replay_one(path) for path in record_paths(out)]


@pytest.fixture
def told(out: Path) -> Results:
    return read_results(out / "results.json")


def with_evaluation(told: Results, evaluation: Evaluation) -> Results:
    return told.model_copy(update={"evaluations": (evaluation,)})


@pytest.fixture
def faults(out: Path) -> Faults:
    """Say in what records and results disagree."""

    def compared(replayed: Sequence[Replayed], told: Results) -> str:
        found = recompute(replayed, told)
        return "\n".join(
            disagreements(replayed, told, found, judge_of(out, told, expected_matches(out, told)))
        )

    return compared


def test_every_number_of_an_evaluation_comes_out_again(
    out: Path, replayed: list[Replayed], told: Results, faults: Faults
) -> None:
    assert recomputed(out, replayed, told) == told
    assert recomputed(out, replayed, told.model_copy(update={"overall": ()})) == told
    identity = read_identity(out)
    assert identity is not None
    asked = identity.model_copy(update={"model": MODEL})
    assert recomputed(out, replayed, None, asked).model == MODEL, "of an evaluation without results yet"
    assert faults(replayed, told) == ""


def test_tables_come_from_the_records_alone(replayed: list[Replayed], told: Results) -> None:
    (evaluation,) = recompute(replayed, None)

    (before,) = told.evaluations
    assert evaluation.summary == before.summary
    assert [row.metrics for row in evaluation.matches] == [row.metrics for row in before.matches]


def test_a_figure_that_was_changed_is_named(replayed: list[Replayed], told: Results, faults: Faults) -> None:
    (evaluation,) = told.evaluations
    better = evaluation.summary["time"].model_copy(update={"mean": 0.5})
    changed = evaluation.model_copy(update={"summary": {**evaluation.summary, "time": better}})

    said = faults(replayed, with_evaluation(told, changed))

    assert said.startswith("homing on navigation: time is 0.5 (")
    assert f"its records give {evaluation.summary['time'].mean} (" in said
    assert len(said.splitlines()) == 1


def test_a_match_that_was_changed_is_named(replayed: list[Replayed], told: Results, faults: Faults) -> None:
    (evaluation,) = told.evaluations
    first, *others = evaluation.matches
    assert first.metrics is not None
    quicker = first.model_copy(update={"metrics": {**first.metrics, "time": 0.5}})
    changed = evaluation.model_copy(update={"matches": (quicker, *others)})

    said = faults(replayed, with_evaluation(told, changed))

    assert "homing on navigation, match 0: the results say time 0.5, " in said


def test_a_match_that_was_left_out_is_named(replayed: list[Replayed], told: Results, faults: Faults) -> None:
    (evaluation,) = told.evaluations
    fewer = evaluation.model_copy(update={"matches": evaluation.matches[1:]})

    said = faults(replayed, with_evaluation(told, fewer))

    assert "homing on navigation, match 0: there is a record, but no result" in said
    assert "there are records, but no results" in faults(
        replayed, told.model_copy(update={"evaluations": ()})
    )


def test_a_record_that_was_taken_away_is_named(
    replayed: list[Replayed], told: Results, faults: Faults
) -> None:
    said = faults(replayed[1:], told)

    assert "homing on navigation, match 0: its record is missing or does not hold" in said
    assert "homing on navigation: time is " in said


def test_a_record_of_another_match_does_not_count_for_this_one(
    out: Path, replayed: list[Replayed], told: Results, faults: Faults, tmp_path: Path
) -> None:
    assert replayed[0].metrics is not None
    easy = tmp_path / "navigation-000-homing.wsr"
    shutil.copy(out / str(replayed[1].record), easy)

    swapped = [replay_one(easy), *replayed[1:]]

    assert "navigation-000-homing.wsr: is not match 0 of the suite" in faults(swapped, told)


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("gathering-000-homing.wsr", "it is of navigation, not of gathering"),
        ("navigation-000-hunter.wsr", "seat 0 belongs to homing, not to hunter"),
        ("mine.wsr", "it is not named as evaluations name records"),
    ],
)
def test_a_record_under_a_wrong_name_does_not_count(
    out: Path, replayed: list[Replayed], tmp_path: Path, name: str, says: str
) -> None:
    shutil.copy(out / str(replayed[0].record), tmp_path / name)

    found = replay_one(tmp_path / name)

    assert (found.fault, found.metrics) == (says, None)


def test_a_damaged_record_does_not_count(out: Path, tmp_path: Path) -> None:
    path = tmp_path / "navigation-000-homing.wsr"
    path.write_bytes((out / "records" / path.name).read_bytes()[:-1])

    assert "checksum" in replay_one(path).fault


def test_matches_of_a_suite_that_is_not_the_one_played_are_no_measure(
    out: Path, told: Results, tmp_path: Path
) -> None:
    theirs = told.model_copy(update={"suite": "theirs@12345678"})
    with pytest.raises(UserError, match=r"suite\.toml: No such file"):
        expected_matches(tmp_path, theirs)

    (tmp_path / "suite.toml").write_text('name = "theirs"\ntracks = { navigation = { maps = 1 } }')
    with pytest.raises(UserError, match="but theirs@12345678 was played"):
        expected_matches(tmp_path, theirs)


def test_the_command_shows_the_tables_and_says_whether_all_agree(
    out: Path, tmp_path: Path, told: Results, capsys: pytest.CaptureFixture[str]
) -> None:
    copy = tmp_path / "out"
    shutil.copytree(out, copy)

    run_rescore(copy, LocalExecutor(1))
    agreed = capsys.readouterr().out
    assert "navigation · suite tiny@" in agreed
    assert "5 records played again: all agree with" in " ".join(agreed.split())

    (evaluation,) = told.evaluations
    changed = evaluation.model_copy(update={"summary": {}})
    write_results(with_evaluation(told, changed), copy)
    with pytest.raises(UserError):
        run_rescore(copy, LocalExecutor(1))
    said = " ".join(capsys.readouterr().err.split())
    assert "success is missing, its records give" in said


def test_records_of_an_evaluation_that_came_to_no_results_yet_are_played_again_all_the_same(
    out: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    copy = tmp_path / "out"
    shutil.copytree(out, copy)
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
