"""Who leads, who is tied, and that a ladder's history never moves."""

import re
from dataclasses import replace
from io import StringIO
from unittest.mock import MagicMock

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.leaderboard.boards.simulated_ladders import CONDITIONS, ROBOTS, board_of, is_lottery, play_ladder
from tests.leaderboard.seasons_made import NOON

from wildscav.terminal.console import PlainConsole
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.output.results import MetricInfo
from wildscav_evaluator.ratings.bands import FEWEST_GAMES
from wildscav_evaluator.ratings.matches import RatedMatch
from wildscav_leaderboard.boards.columns import columns_of
from wildscav_leaderboard.boards.documents import FEWEST_MATCHES, Entry, LadderBoard, SuiteBoard
from wildscav_leaderboard.boards.ladder_board import Enough, ladder_board
from wildscav_leaderboard.boards.ladders import Played, placed_match
from wildscav_leaderboard.boards.matchmaking import REPEATS
from wildscav_leaderboard.boards.ranks import better_in_pairs, rank_ranges
from wildscav_leaderboard.boards.suite_board import SuiteResults, suite_board
from wildscav_leaderboard.competing import boards
from wildscav_leaderboard.web.charts import Scale

TIME = (MetricInfo(name="time", title="time", unit="s", lower_is_better=True),)


def results(number: int, team: str, times: list[float], planned: int = 20) -> SuiteResults:
    name = f"agent{number}"
    return SuiteResults(
        entry=Entry(name, number, name, "1", team, team.title(), NOON),
        planned=planned,
        faults=0,
        metrics={index: {"time": time} for index, time in enumerate(times)},
    )


def times(mean: float) -> list[float]:
    """Times of twenty matches of very different lengths, each a little off."""
    return [mean + 40.0 * (index % 5) + 0.1 * (index * 7 % 3) for index in range(20)]


def board_of_suite(*found: SuiteResults, metrics: tuple[MetricInfo, ...] = TIME) -> SuiteBoard:
    return suite_board("navigation", CONDITIONS, metrics, found, NOON)


@pytest.mark.parametrize(("width", "is_whole"), [(80, False), (120, True)])
def test_a_narrow_terminal_shows_a_sum_without_its_parts(
    monkeypatch: pytest.MonkeyPatch, width: int, *, is_whole: bool
) -> None:
    shown = PlainConsole(width=width, file=StringIO())
    monkeypatch.setattr(boards, "console", shown)
    metrics = tuple(MetricInfo(**one._asdict()) for one in TRACKS["navigation"].metrics)
    each = {one.name: 0.5 for one in metrics}
    found = replace(results(1, "owls", []), metrics=dict.fromkeys(range(20), each))
    boards._print(MagicMock(), [board_of_suite(found, metrics=metrics)])

    text = shown.file.getvalue()  # type: ignore[attr-defined]
    assert re.search(r"1 +Owls +1: ", text)  # side by side
    assert text.count("[s]") == (3 if is_whole else 1)
    assert "success" in text


def test_a_small_lead_in_every_match_is_enough_where_matches_differ_much() -> None:
    board = board_of_suite(results(1, "owls", times(11.0)), results(2, "foxes", times(10.0)))
    assert [(row.team, row.ranks) for row in board.rows] == [("foxes", "1"), ("owls", "2")]


def test_a_metric_that_results_of_an_older_version_lack_has_no_column() -> None:
    spl = MetricInfo(name="spl", title="SPL", unit="", lower_is_better=False)
    old, new = results(1, "owls", times(11.0)), results(2, "foxes", times(10.0))
    new = replace(new, metrics={index: {**values, "spl": 0.5} for index, values in new.metrics.items()})
    both, alone = (board_of_suite(*found, metrics=(*TIME, spl)) for found in ((old, new), (new,)))
    assert [metric.name for metric in both.metrics] == ["time"]
    assert alone.rows[0].metrics["spl"].mean == 0.5


def test_a_row_says_by_which_interface_its_submission_plays_unless_by_numbers() -> None:
    by_words = results(1, "owls", times(11.0))
    by_words = replace(by_words, entry=replace(by_words.entry, interface="words"))
    board = board_of_suite(by_words, results(2, "foxes", times(10.0)))

    assert [row.agent for row in board.rows] == ["agent2 1", "agent1 1 (words)"]
    # Releases before the field read boards without it.
    assert [row.get("interface") for row in board.model_dump(mode="json")["rows"]] == [None, "words"]
    assert "interface" not in board.model_dump(mode="json")["rows"][0]


def test_who_cannot_be_told_apart_is_tied() -> None:
    wavering = [time + (3.0 if index % 2 else -3.0) for index, time in enumerate(times(10.0))]
    board = board_of_suite(results(1, "owls", times(10.1)), results(2, "foxes", wavering))
    assert [row.ranks for row in board.rows] == ["1–2", "1–2"]


def test_a_team_stands_with_its_best_submission_and_only_with_a_complete_one() -> None:
    board = board_of_suite(
        results(1, "foxes", times(12.0)),
        results(2, "foxes", times(10.0)),
        results(3, "foxes", times(1.0)[:5]),  # still playing
        results(4, "owls", times(1.0)[:5]),
    )
    assert [(row.team, row.submission, row.ranks) for row in board.rows] == [
        ("foxes", 2, "1"),
        ("owls", 4, ""),
    ]
    # Each change of a figure that comes and goes would tell how one match went.
    assert [(row.matches, row.metrics.keys()) for row in board.rows] == [(20, {"time"}), (5, set())]


def test_with_fewer_than_six_matches_everyone_is_tied() -> None:
    scores = np.array([[1.0] * 5, [9.0] * 5])
    assert rank_ranges(better_in_pairs(scores, lower_is_better=True)) == [(1, 2), (1, 2)]


@given(st.integers(2, 12), st.integers(6, 30), st.integers(0, 2**32 - 1))
def test_rank_ranges_hold_together(count: int, matches: int, seed: int) -> None:
    scores = np.random.default_rng(seed).normal(np.arange(count)[:, np.newaxis] % 4, 1.0, (count, matches))
    better = better_in_pairs(scores, lower_is_better=False)
    ranges = rank_ranges(better)
    assert not (better & better.T).any()
    assert all(1 <= low <= high <= count for low, high in ranges)
    for one, other in zip(*np.nonzero(better), strict=True):
        assert ranges[one][0] <= ranges[other][0]
        assert scores[one].mean() > scores[other].mean()


def duels(*pairs: str) -> tuple[RatedMatch, ...]:
    """Return games of two entrants, each played twice with the same end, such as "ab": a beats b."""
    ends = [placed_match(number, [(pair[0], 1), (pair[1], 2)]) for number, pair in enumerate(pairs * 2)]
    return tuple(replace(end, game=game % len(pairs)) for game, end in enumerate(ends))


def ladder_of(matches: tuple[RatedMatch, ...], names: str, most: int = 100) -> LadderBoard:
    entrants = [Entry(name, number, name, team=name) for number, name in enumerate(names, 1)]
    return ladder_board("battle", CONDITIONS, TIME, entrants, Played(matches), Enough(400.0, most), NOON)


def test_a_ladder_ties_those_that_are_equal_and_ranks_nobody_before_a_match() -> None:
    matches = duels(*["ab", "ba"] * 12, *["ac", "bc"] * 12)
    board = ladder_of(matches, "abcd")
    places = [(row.team, row.ranks) for row in board.rows]
    assert places == [("a", "1–2"), ("b", "1–2"), ("c", "3"), ("d", "")]


def test_before_its_first_match_a_rating_says_nothing() -> None:
    board = ladder_of(duels("ab"), "abc")
    shown = {
        row.team: [f"{one.text(row)} {one.note(row)}".strip() for one in columns_of(board)]
        for row in board.rows
    }
    assert "±" not in shown["a"][0]
    assert shown["a"][1] == "2 matches provisional"
    assert shown["a"][2:] == ["1.00", "2", "2 of 100", "0"]  # mean place, wins, matches, faults
    assert shown["c"] == ["", "", "", "0", "0 of 100", "0"]


@pytest.mark.parametrize(
    ("games", "shown"), [(5, "10 matches"), (6, "1,"), (40, "1,")], ids=["few", "enough", "settled"]
)
def test_an_interval_is_shown_once_it_says_something(games: int, shown: str) -> None:
    assert FEWEST_MATCHES == REPEATS * FEWEST_GAMES
    board = ladder_of(duels(*(["ab", "ba"] * 20)[:games]), "ab")
    interval = columns_of(board)[1]

    for row in board.rows:
        assert interval.text(row).startswith(shown)
        assert (Scale.of(board).bar(row) is None) == (shown == "10 matches")
        assert -1000 < row.low < row.high < 4000  # the document has them in any case


def test_who_has_played_all_matches_of_a_short_ladder_has_an_interval() -> None:
    for planned, is_shown in ((10, True), (11, False)):
        board = ladder_of(duels(*["ab", "ba", "ab", "ba", "ab"]), "ab", planned)
        assert {row.matches for row in board.rows} == {10}
        assert {row.is_measured for row in board.rows} == {is_shown}


def test_who_won_its_few_matches_is_provisional_and_does_not_lead() -> None:
    board = ladder_of(duels(*["ab", "ba", "ab", "ab"] * 10, "nb", "na"), "abn")
    rows = {row.team: row for row in board.rows}
    assert rows["n"].rating > rows["a"].rating
    assert [(row.team, row.provisional) for row in board.rows] == [("a", False), ("b", False), ("n", True)]
    assert rows["n"].ranks == "1–3"
    assert (rows["n"].planned, rows["a"].planned) == (100, rows["a"].matches)


@pytest.mark.slow
def test_identical_submissions_are_not_told_apart_however_many_seasons_they_play() -> None:
    """OpenSkill's ratings, with opponents of the nearest rating, told them apart in 87 % of seasons."""
    twins = {f"twin{number}": 1.0 for number in range(10)}
    enough = Enough(200.0, 100)
    boards = [
        board_of(twins | ROBOTS, play_ladder(twins | ROBOTS, seed, enough), enough) for seed in range(12)
    ]
    assert sum(is_lottery(board, list(twins)) for board in boards) <= 2  # 5 % are promised
    rows = [row for board in boards for row in board.rows if row.team]
    assert not any(row.provisional for row in rows)
    middle = 1500.0 + (1.0 - np.mean([1.0] * 10 + list(ROBOTS.values()))) * 400.0 / np.log(10.0)
    assert np.mean([row.low <= middle <= row.high for row in rows]) > 0.88  # 95 % are promised of each
