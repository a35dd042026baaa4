"""Who leads, from the results in folders."""

from pathlib import Path
from typing import Any

import pytest
from tests.evaluator.results_by_hand import MODEL, saved, scored_results

from wildscav.errors import UserError
from wildscav_evaluator.cli.sessions.leaderboard import show_standings
from wildscav_evaluator.output.results import CURRENT_VERSIONS, Results
from wildscav_evaluator.scores.leaderboard import document, find_results, standings

Ranks = list[tuple[int | None, str]]
LATER = "2030-01-02T00:00:00+00:00"


def ranks(*results: Results, **wanted: str) -> list[Ranks]:
    """The rows of every table, with rank and name."""
    return [
        [(row.rank, row.evaluation.submission) for row in one.rows] for one in standings(results, **wanted)
    ]


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
        ("navigation", {"c": [], "a": [], "b": [3.0]}, [(1, "b"), (None, "a"), (None, "c")]),
        ("gathering", {"a": [], "b": [0.0]}, [(1, "b"), (None, "a")]),
    ],
)
def test_order(track: str, scores: dict[str, list[float]], order: Ranks) -> None:
    assert ranks(scored_results({(name, track): row for name, row in scores.items()})) == [order]


@pytest.mark.parametrize("latest_first", [False, True])
def test_a_submission_stands_there_once_with_its_latest_evaluation(latest_first: bool) -> None:
    both = scored_results({("a", "gathering"): [9.0], ("b", "gathering"): [5.0]})
    worse = scored_results({("a", "gathering"): [1.0]}, version="2.0.0", started=LATER)

    assert ranks(*([worse, both] if latest_first else [both, worse])) == [[(1, "b"), (2, "a")]]


@pytest.mark.parametrize(
    "changed",
    [
        {"seed": 1},
        {"seed": None, "commitment": "ab" * 32},
        {"suite": "spring@19da5d55"},
        {"rounds": 2},
        # Developed without a sandbox, where all of the machine is an agent's, and later than it was judged.
        {"sandbox": "oci"},
        {"memory": 2**30},
        {"model": MODEL},
        *(
            {"versions": CURRENT_VERSIONS.model_copy(update={part: "9" if part == "engine" else 99})}
            for part in ("engine", "simulation", "generator", "record")
        ),
    ],
    ids=str,
)
def test_what_was_played_under_other_conditions_is_not_compared(changed: dict[str, Any]) -> None:
    before = scored_results({("a", "gathering"): [9.0], ("b", "gathering"): [5.0]})
    after = scored_results({("b", "gathering"): [99.0]}, started=LATER, **changed)

    assert sorted(ranks(before, after), key=len) == [[(1, "b")], [(1, "a"), (2, "b")]]


def test_a_track_or_a_suite_can_be_asked_for_alone() -> None:
    results = scored_results({("a", "gathering"): [1.0], ("a", "navigation"): [1.0]})

    def tracks(**wanted: str) -> list[str]:
        return [one.conditions.track for one in standings([results], **wanted)]

    assert tracks(track="gath") == ["gathering"]
    assert tracks(suite="quick") == ["navigation", "gathering"], "in the order of the engine's tracks"
    assert tracks(suite="official") == []


def test_all_interfaces_share_a_ranking_which_says_by_which_each_plays(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    results = scored_results({("ada", "gathering"): [1.0], ("bob", "gathering"): [2.0]})
    ada, bob = results.evaluations
    reads = results.model_copy(update={"evaluations": (ada, bob.model_copy(update={"interface": "words"}))})

    (one,) = standings([reads])
    assert [(row["submission"], row["interface"]) for row in document(one)["rows"]] == [
        ("bob", "words"),
        ("ada", "numbers"),
    ]
    show_standings([saved(reads, tmp_path / "out")])
    assert "bob 1.0.0 (words)" in capsys.readouterr().out
    assert '"interface"' not in results.model_dump_json()


def test_a_match_without_a_result_and_a_limit_stand_in_the_document() -> None:
    (one,) = standings([scored_results({("a", "navigation"): []}, memory=2**30, key="ab" * 32)])

    told = document(one)
    assert told["limits"] == {"memory": 2**30}
    (row,) = told["rows"]
    assert (row["rank"], row["matches"], row["faults"], row["scores"]) == (None, 1, 1, [])
    assert (row["key"], row["started"]) == ("ab" * 32, "2030-01-01T00:00:00+00:00")


def test_evaluations_are_found_at_any_depth_and_comparisons_are_left_out(tmp_path: Path) -> None:
    results = scored_results({("a", "navigation"): [1.0]})
    saved(results, tmp_path / "mine")
    (saved(results, tmp_path / "comparisons" / "0001-a-b") / "comparison.json").touch()
    other = saved(results, tmp_path / "evaluations" / "0001-a")
    saved(results, other / "copy")  # inside an evaluation
    (tmp_path / "evaluations" / "0002-interrupted" / "records").mkdir(parents=True)
    (saved(results, tmp_path / "evaluations" / "0003-odd") / "results.json").write_text("{}")

    found = find_results([tmp_path])

    assert len(found.evaluations) == 2
    (line,) = found.unreadable
    assert "0003-odd/results.json is not a results file" in line
    assert len(find_results([other / "results.json", tmp_path / "mine"]).evaluations) == 2
    with pytest.raises(UserError, match=r"0003-odd/results\.json is not"):
        find_results([tmp_path / "evaluations" / "0003-odd"])
    with pytest.raises(UserError, match="nowhere does not exist"):
        find_results([tmp_path / "nowhere"])
