"""Who plays whom: known designs are found, and searches lose nobody."""

import numpy as np
import pytest

from wildscav_evaluator.tournaments.draws import Draws
from wildscav_evaluator.tournaments.meetings import count_meetings, spread_of
from wildscav_evaluator.tournaments.pairings import (
    balanced_after,
    lattice,
    lattice_rounds,
    pair_up,
    pair_up_groups,
)
from wildscav_evaluator.tournaments.shift_search import search_shifts
from wildscav_evaluator.tournaments.swap_search import search_swaps


@pytest.mark.parametrize(
    ("entrants", "places", "rounds"),
    [
        (9, 3, 4),
        (16, 4, 5),
        (25, 5, 6),
        (27, 3, 13),  # of nine games, then four rounds in each class of nine
        (64, 8, 9),
        (81, 9, 10),
        (12, 3, 4),  # classes of four cannot play among themselves in threes
        (1000, 10, 0),  # 100 is no power of a prime
        (15, 5, 0),  # classes of three are too small for five
        (10, 4, 0),
    ],
)
def test_lattices_have_known_lengths(entrants: int, places: int, rounds: int) -> None:
    assert lattice_rounds(entrants, places) == rounds


@pytest.mark.parametrize(("entrants", "places"), [(9, 3), (16, 4), (27, 3), (64, 8), (81, 9)])
def test_after_a_whole_lattice_everyone_has_met_everyone_once(entrants: int, places: int) -> None:
    games = lattice(entrants, places, lattice_rounds(entrants, places))

    met = count_meetings(games, entrants)
    assert (met[~np.eye(entrants, dtype=bool)] == 1).all()
    assert (met.diagonal() == len(games)).all()


@pytest.mark.parametrize(
    ("entrants", "places", "rounds"),
    [
        (8, 2, 7),
        (9, 2, 4),
        (7, 3, 1),  # seven games, in each of which three meet two others
        (10, 4, 3),  # six games with three others in a round: 3 × 6 / 9 = 2
        (13, 4, 1),
        (16, 4, 5),
    ],
)
def test_the_least_rounds_for_equal_meetings(entrants: int, places: int, rounds: int) -> None:
    assert balanced_after(entrants, places) == rounds


@pytest.mark.parametrize(
    ("entrants", "places", "rounds", "games"),
    [(7, 3, 1, 7), (15, 3, 7, 35), (21, 5, 1, 21), (31, 6, 1, 31), (8, 4, 7, 14), (13, 9, 1, 13)],
)
def test_known_designs_are_found(entrants: int, places: int, rounds: int, games: int) -> None:
    found = pair_up(entrants, places, rounds)

    assert found.shape == (rounds, games // rounds, places)
    assert spread_of(count_meetings(found, entrants), range(entrants)) == 0


def test_long_schedules_repeat_what_is_balanced() -> None:
    """Eight in fours: all pairs have met three times after 7 rounds, and 300 times after 700."""
    met = count_meetings(pair_up(8, 4, 701), 8)

    assert set(met[~np.eye(8, dtype=bool)].tolist()) == {300, 301}


def test_games_of_hundreds_are_made_in_parts() -> None:
    games = pair_up(1000, 400, 30)  # more than are searched at once

    assert games.shape == (30, 5, 400)
    assert (np.sort(games.reshape(30, 2000), axis=1) == np.repeat(np.arange(1000), 2)).all()
    assert (np.diff(np.sort(games, axis=2), axis=2) > 0).all()


def test_a_search_by_shifts_counts_what_it_made() -> None:
    games = search_shifts(22, 4, 3, 100_000, Draws("test"))

    assert (np.diff(np.sort(games, axis=2), axis=2) > 0).all()
    assert (count_meetings(games, 22).diagonal() == 6).all()


def test_a_search_by_swaps_makes_meetings_more_even() -> None:
    start = np.stack([np.arange(20).reshape(5, 4)] * 4)  # the same games in all four rounds

    found = search_swaps(start[None].copy(), np.eye(20, dtype=bool), 500, Draws("test"))

    met = count_meetings(found, 20)
    assert spread_of(met, range(20)) <= 2  # it was 4
    assert (np.sort(found.reshape(4, 20), axis=1) == np.arange(20)).all()


def test_groups_that_fill_every_game_still_play_equally_often() -> None:
    """Three groups of three in threes: each game has one of each, and in three rounds all of them meet."""
    games = pair_up_groups((0, 0, 0, 1, 1, 1, 2, 2, 2), 3, 3)

    met = count_meetings(games, 9)
    assert (np.sort(games // 3, axis=2) == np.arange(3)).all()
    assert spread_of(met, np.repeat(np.arange(3), 3).tolist()) == 0
    assert met[0, 3] == 1


def test_many_meetings_are_counted_as_few_are(monkeypatch: pytest.MonkeyPatch) -> None:
    games = pair_up(30, 7, 4)
    listed = count_meetings(games, 30)

    monkeypatch.setattr("wildscav_evaluator.tournaments.meetings.MANY_CELLS", 0)

    assert (count_meetings(games, 30) == listed).all()


def test_draws_are_philox_and_stay_what_they_are() -> None:
    draws = Draws("a", 1)

    assert draws.words(2).tolist() == [18060064335630236126, 1650220348908585770]
    assert draws.below(10, 2, 3).tolist() == [[5, 2, 4], [9, 4, 6]]
    assert draws.nibbles(5).tolist() == [3, 11, 5, 2, 15]
    assert draws.order(6).tolist() == [0, 5, 4, 2, 3, 1]
