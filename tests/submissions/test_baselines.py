"""The baselines: submissions like any other, and each better than the one before at what it is for."""

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from wildscav_evaluator.matches.jobs import Job, JobResult
from wildscav_evaluator.matches.workers import Workers
from wildscav_evaluator.output.folder import FOLDERS
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_evaluator.suites.suite import suite

SUBMISSIONS = Path(__file__).parents[2] / "submissions"
NAMES = ("random", "homing", "hunter")


@pytest.fixture(scope="module")
def workers() -> Iterator[Workers]:
    with Workers(2) as pool:
        pool.precompile()
        yield pool


def jobs(name: str, track: str, seed: int, out: Path) -> list[Job]:
    for folder in FOLDERS:
        (out / folder).mkdir(parents=True, exist_ok=True)
    submission = load_submission(SUBMISSIONS / name)
    specs = enumerate(suite(track, "quick", seed))
    return [Job(submission, track, index, spec, out, replay=False) for index, spec in specs]


def play(workers: Workers, wanted: list[Job]) -> list[JobResult]:
    results = list(workers.run(wanted))
    assert [result.row.detail for result in results if result.row.fault] == []
    return results


def mean(results: list[JobResult], name: str, metric: str) -> float:
    values = [(result.row.metrics or {})[metric] for result in results if result.job.submission.name == name]
    return sum(values) / len(values)


@pytest.mark.parametrize("name", NAMES)
def test_they_import_the_sdk_and_the_standard_library_alone(name: str) -> None:
    folder = SUBMISSIONS / name
    own = {path.stem for path in folder.glob("*.py")}
    for path in folder.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            modules = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            modules += [str(node.module)] if isinstance(node, ast.ImportFrom) else []
            for module in modules:
                root = module.partition(".")[0]
                assert root in own | {"wildscav"} | sys.stdlib_module_names, f"{path}: {module}"


def test_hunter_steers_as_homing_does() -> None:
    homing, hunter = (SUBMISSIONS / name / "steering.py" for name in ("homing", "hunter"))

    assert homing.read_bytes() == hunter.read_bytes()


@pytest.mark.parametrize("track", ["navigation", "gathering", "battle"])
def test_the_same_match_is_played_the_same_way(workers: Workers, tmp_path: Path, track: str) -> None:
    first = [jobs(name, track, 0, tmp_path / "first")[0] for name in NAMES]
    second = [jobs(name, track, 0, tmp_path / "second")[0] for name in NAMES]

    play(workers, first + second)

    for one, other in zip(first, second, strict=True):
        assert (one.out / one.record).read_bytes() == (other.out / other.record).read_bytes()


@pytest.mark.slow
def test_homing_reaches_most_targets_and_random_few(workers: Workers, tmp_path: Path) -> None:
    wanted = [
        job
        for name in ("random", "homing")
        for seed in (0, 1)
        for job in jobs(name, "navigation", seed, tmp_path)
    ]

    results = play(workers, wanted)

    assert mean(results, "homing", "success") >= 0.8
    assert mean(results, "homing", "time") < mean(results, "random", "time") / 2


def test_homing_gathers_more_than_random(workers: Workers, tmp_path: Path) -> None:
    results = play(
        workers, [job for name in ("random", "homing") for job in jobs(name, "gathering", 0, tmp_path)]
    )

    assert mean(results, "homing", "supplies") > 2 * mean(results, "random", "supplies")


def test_hunter_gathers_and_kills(workers: Workers, tmp_path: Path) -> None:
    results = play(workers, [job for name in NAMES for job in jobs(name, "battle", 1, tmp_path)])

    assert mean(results, "hunter", "kills") >= 1.0
    assert mean(results, "hunter", "kills") > mean(results, "homing", "kills")
    assert mean(results, "hunter", "supplies") > 0.0
