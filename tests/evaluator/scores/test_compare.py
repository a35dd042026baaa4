"""Which of two submissions is better, by the matches that both played."""

import json
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from tests.commands import Run, run_command
from tests.evaluator.results_by_hand import evaluation, scored_results
from tests.evaluator.sample_agents import Submit

from wildscav_evaluator.cli.sessions.compare import comparison_table, verdict_line, with_distinct_names
from wildscav_evaluator.scores.compare import Comparison, compare, compare_evaluations, judge

HARD_AND_EASY = [10.0, 200.0, 30.0, 150.0, 60.0, 90.0, 20.0, 180.0]  # supplies of matches unlike each other
SUBMISSIONS = Path(__file__).parents[3] / "submissions"


def compared(
    first: Sequence[float | None], second: Sequence[float | None], track: str = "gathering"
) -> Comparison:
    results = scored_results({("ada", track): first, ("bob", track): second})
    (comparison,) = compare(results, "ada", "bob").comparisons
    return comparison


def test_a_small_lead_in_every_match_shows_though_the_matches_are_unlike_each_other() -> None:
    ahead = [value + 5.0 + (index % 3) for index, value in enumerate(HARD_AND_EASY)]
    alone = [evaluation("ada", "gathering", values) for values in (ahead, HARD_AND_EASY)]

    comparison = compared(ahead, HARD_AND_EASY)

    assert comparison.verdict == "first"
    difference = comparison.differences[0]
    assert 5.0 <= difference.low <= difference.difference <= difference.high <= 7.0
    # Side by side the two intervals say nothing.
    first, second = (one.summary["supplies"] for one in alone)
    assert first.low < second.mean < first.high


def test_the_same_values_the_other_way_round_give_the_other_verdict() -> None:
    ahead = [value + 5.0 for value in HARD_AND_EASY]

    assert compared(ahead, HARD_AND_EASY).verdict == "first"
    assert compared(HARD_AND_EASY, ahead).verdict == "second"
    assert compared(ahead, HARD_AND_EASY, "navigation").verdict == "second"
    assert compared(HARD_AND_EASY, ahead, "navigation").verdict == "first"


def test_submissions_that_play_the_same_are_tied() -> None:
    comparison = compared(HARD_AND_EASY, HARD_AND_EASY)

    assert comparison.verdict == "tied"
    assert (comparison.differences[0].low, comparison.differences[0].high) == (0.0, 0.0)


def test_equals_are_found_different_in_one_case_of_twenty() -> None:
    dice = np.random.default_rng(7)
    verdicts = [
        compared(dice.normal(0, 1, 20).tolist(), dice.normal(0, 1, 20).tolist()).verdict for _ in range(200)
    ]

    assert 0.9 < verdicts.count("tied") / 200 < 0.99


@pytest.mark.parametrize(
    ("low", "high", "pairs", "lower_is_better", "verdict"),
    [
        (1.0, 2.0, 10, False, "first"),
        (1.0, 2.0, 10, True, "second"),
        (-2.0, -1.0, 10, False, "second"),
        (-2.0, -1.0, 10, True, "first"),
        (-1.0, 1.0, 10, False, "tied"),
        (0.0, 1.0, 10, False, "tied"),  # zero is in the interval
        (1.0, 2.0, 6, False, "first"),
        (1.0, 2.0, 5, False, "too few"),
    ],
)
def test_verdicts(low: float, high: float, pairs: int, lower_is_better: bool, verdict: str) -> None:
    assert judge(low, high, pairs, lower_is_better=lower_is_better) == verdict


def test_a_match_that_the_platform_lost_is_left_out_for_both() -> None:
    comparison = compared([None, *HARD_AND_EASY[1:]], [*HARD_AND_EASY[:-1], None])

    assert (comparison.pairs, comparison.dropped, comparison.verdict) == (6, 2, "tied")
    assert "2 matches left out: the platform failed" in verdict_line(comparison).plain
    nothing = compared([None], [1.0])
    assert (nothing.pairs, nothing.verdict, nothing.differences) == (0, "too few", ())
    assert "0 matches are too few to decide: at least 6 needed" in verdict_line(nothing).plain
    assert comparison_table(nothing).row_count == 0


def test_it_is_said_that_two_play_by_different_interfaces() -> None:
    one, other = evaluation("ada"), evaluation("bob")
    reads = other.model_copy(update={"interface": "words"})

    assert "interfaces" not in compare_evaluations(one, other).model_dump()
    assert verdict_line(compare_evaluations(one, reads)).plain.endswith(
        "(ada plays by numbers, bob by words)"
    )


def test_two_versions_of_one_submission_are_with_distinct_names(submit: Submit) -> None:
    walker, other = submit("walker", "pass"), submit("other", "pass")

    assert with_distinct_names([walker, other]) == (walker, other)
    assert [one.name for one in with_distinct_names([walker, walker])] == ["walker-a", "walker-b"]


@pytest.fixture
def command(tmp_path: Path) -> Run:
    """Run `wildscav compare`."""
    return partial(run_command, "compare", cwd=tmp_path, columns=200)


def test_tracks_that_not_both_play_are_refused(command: Run, submit: Submit) -> None:
    walker, gatherer = submit("walker", "pass"), submit("gatherer", "pass", tracks='["gathering"]')

    refused = command(walker.folder, gatherer.folder)

    assert refused.returncode == 2
    assert "suite quick has no track that both" in refused.stderr


@pytest.mark.slow
def test_the_better_agent_is_named_and_all_is_kept(command: Run, tmp_path: Path) -> None:
    (tmp_path / "short.toml").write_text(
        'name = "short"\nmap = { size = 40, houses = 0 }\n'
        "[tracks.navigation]\nmaps = 4\nepisodes = 1\nmatch = { time_limit = 20 }\n"
    )
    folders = (SUBMISSIONS / "homing", SUBMISSIONS / "random")
    options = ("--suite=short.toml", "--workers=1", "--out=out")

    done = command(*folders, *options)

    assert done.returncode == 0, done.stderr
    assert "navigation · 8 matches that both played" in done.stdout
    assert "homing is better than random by its used + punish time" in done.stdout
    kept = json.loads((tmp_path / "out/comparison.json").read_text())
    assert kept["comparisons"][0]["differences"][0]["verdict"] == "first"
    again = command(*folders, *options)
    assert "all 16 matches were played before" in again.stdout
