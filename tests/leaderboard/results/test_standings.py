"""Who leads."""

from collections.abc import Callable
from pathlib import Path

import pytest

from wildscav_evaluator.output.results import Results, Versions
from wildscav_leaderboard.results.database import reading
from wildscav_leaderboard.results.sink import DatabaseSink
from wildscav_leaderboard.results.standings import standings

Make = Callable[..., Results]
Ranks = list[tuple[int | None, str]]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "wildscav.db"


def ranks(path: Path, **wanted: str) -> dict[tuple[str, str], Ranks]:
    with reading(path) as session:
        return {
            (one.track, one.seed): [(row.rank, row.evaluation.submission.name) for row in one.rows]
            for one in standings(session, **wanted)
        }


@pytest.mark.parametrize(
    ("track", "scores", "order"),
    [
        # Supplies: more is better.
        ("gathering", {"a": [1.0], "b": [3.0], "c": [2.0]}, [(1, "b"), (2, "c"), (3, "a")]),
        # Time: less is better.
        ("navigation", {"a": [1.0], "b": [3.0], "c": [2.0]}, [(1, "a"), (2, "c"), (3, "b")]),
        # Equal scores share a rank, and the next one is skipped.
        ("gathering", {"a": [1.0], "c": [2.0], "b": [2.0]}, [(1, "b"), (1, "c"), (3, "a")]),
        # The mean counts, not the best match.
        ("gathering", {"a": [9.0, 0.0], "b": [5.0, 5.0]}, [(1, "b"), (2, "a")]),
        # Without a score there is no rank, whichever way is better.
        ("navigation", {"a": [], "b": [3.0]}, [(1, "b"), (None, "a")]),
        ("gathering", {"a": [], "b": [0.0]}, [(1, "b"), (None, "a")]),
    ],
)
def test_order(
    make_results: Make, path: Path, track: str, scores: dict[str, list[float]], order: Ranks
) -> None:
    DatabaseSink(str(path)).store(make_results({(name, track): row for name, row in scores.items()}))

    assert ranks(path) == {(track, "0"): order}


def test_a_submission_stands_there_once_with_its_latest_evaluation(make_results: Make, path: Path) -> None:
    sink = DatabaseSink(str(path))
    sink.store(make_results({("a", "gathering"): [9.0], ("b", "gathering"): [5.0]}))
    sink.store(
        make_results({("a", "gathering"): [1.0]}, version="2.0.0", started="2030-01-02T00:00:00+00:00")
    )

    assert ranks(path) == {("gathering", "0"): [(1, "b"), (2, "a")]}


def test_matches_of_other_seeds_are_not_compared(make_results: Make, path: Path) -> None:
    sink = DatabaseSink(str(path))
    sink.store(make_results({("a", "gathering"): [1.0]}, seed=0))
    sink.store(make_results({("b", "gathering"): [2.0]}, seed=1))

    assert ranks(path) == {("gathering", "0"): [(1, "a")], ("gathering", "1"): [(1, "b")]}


def test_agents_in_other_sandboxes_are_not_compared(make_results: Make, path: Path) -> None:
    sink = DatabaseSink(str(path))
    sink.store(make_results({("a", "gathering"): [9.0], ("b", "gathering"): [5.0]}, sandbox="bubblewrap"))
    # Developed without a sandbox, where all of the machine is an agent's, and later than it was judged.
    later = "2030-01-02T00:00:00+00:00"
    sink.store(make_results({("b", "gathering"): [99.0]}, sandbox="process", started=later))

    with reading(path) as session:
        found = {
            one.sandbox: [row.evaluation.submission.name for row in one.rows] for one in standings(session)
        }
    assert found == {"bubblewrap": ["a", "b"], "process": ["b"]}


@pytest.mark.parametrize("part", ["engine", "simulation", "generator", "record"])
def test_what_other_versions_played_is_not_compared(make_results: Make, path: Path, part: str) -> None:
    sink = DatabaseSink(str(path))
    before = Versions(engine="0.1.0", simulation=2, generator=3, record=2)
    after = before.model_copy(update={part: "0.2.0" if part == "engine" else 4})
    sink.store(make_results({("a", "gathering"): [9.0], ("b", "gathering"): [5.0]}, versions=before))
    # The same submission again, after a change of the rules, the maps or the format of records.
    sink.store(make_results({("b", "gathering"): [99.0]}, versions=after))

    with reading(path) as session:
        found = [[row.evaluation.submission.name for row in one.rows] for one in standings(session)]
    assert found == [["a", "b"], ["b"]]


def test_a_track_or_a_suite_can_be_asked_for_alone(make_results: Make, path: Path) -> None:
    scores = {("a", "gathering"): [1.0], ("a", "navigation"): [1.0]}
    DatabaseSink(str(path)).store(make_results(scores))

    assert list(ranks(path, track="gathering")) == [("gathering", "0")]
    assert list(ranks(path, suite="quick")) == [("navigation", "0"), ("gathering", "0")]
    assert ranks(path, suite="official") == {}
