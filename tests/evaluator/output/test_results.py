"""Results files: what this version reads, and what it says of others."""

import json
from pathlib import Path

import pytest

from wildscav.errors import UserError
from wildscav_evaluator.output.results import CURRENT_VERSIONS, Results, Timings, read_results, write_results

NOTHING = Timings(started="", wall=0.0, jobs=1, matches=())


@pytest.fixture
def results() -> Results:
    return Results(
        versions=CURRENT_VERSIONS, suite="quick", seed=0, sandbox="process", evaluations=(), timings=NOTHING
    )


def test_results_say_by_which_versions_they_came_about(results: Results, tmp_path: Path) -> None:
    path = write_results(results, tmp_path)

    assert read_results(path) == results
    assert json.loads(path.read_text())["versions"].keys() == {"engine", "simulation", "generator", "record"}


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("{}", "is not a results file of format 2: versions: Field required"),
        ("[1, 2]", "is not a results file of format 2"),
        ('{"format": 1}', "is not a results file of format 2"),
        ("[" * 100_000, "is not a results file of format 2"),
        ("no JSON", "is not a results file of format 2"),
    ],
)
def test_what_is_no_results_file_is_one_clear_line(tmp_path: Path, content: str, says: str) -> None:
    path = tmp_path / "results.json"
    path.write_text(content)

    with pytest.raises(UserError, match=says) as refused:
        read_results(path)

    assert "\n" not in str(refused.value)
