"""Who plays whom: everyone equally often, and all pairs about equally often."""

import numpy as np
import pytest

from wildscav_evaluator.tournaments.draws import Draws
from wildscav_evaluator.tournaments.meetings import count_meetings, even_out, spread_of
from wildscav_evaluator.tournaments.pairings import pair_up


@pytest.mark.parametrize(
    ("entrants", "places", "rounds", "games"),
    [(7, 3, 1, 7), (9, 3, 4, 12), (16, 4, 5, 20), (13, 4, 1, 13), (8, 4, 7, 14), (13, 9, 1, 13)],
)
def test_known_designs_are_found(entrants: int, places: int, rounds: int, games: int) -> None:
    found = pair_up(tuple(range(entrants)), places, rounds)

    assert found.shape == (rounds, games // rounds, places)
    assert spread_of(count_meetings(found, entrants), range(entrants)) == 0


def test_games_of_hundreds_are_made() -> None:
    games = pair_up(tuple(range(1000)), 400, 3)

    assert games.shape == (3, 5, 400)
    assert (np.sort(games.reshape(3, 2000), axis=1) == np.repeat(np.arange(1000), 2)).all()
    assert (np.diff(np.sort(games, axis=2), axis=2) > 0).all()


def test_swaps_make_meetings_more_even() -> None:
    start = np.stack([np.arange(20).reshape(5, 4)] * 4)  # the same games in all four rounds

    found = even_out(start, range(20), Draws("test"))

    assert spread_of(count_meetings(found, 20), range(20)) == 1  # it was 4
    assert (np.sort(found.reshape(4, 20), axis=1) == np.arange(20)).all()


def test_groups_that_fill_every_game_still_play_equally_often() -> None:
    """Three groups of three in threes: each game has one of each, and in three rounds all of them meet."""
    games = pair_up((0, 0, 0, 1, 1, 1, 2, 2, 2), 3, 3)

    met = count_meetings(games, 9)
    assert (np.sort(games // 3, axis=2) == np.arange(3)).all()
    assert spread_of(met, np.repeat(np.arange(3), 3).tolist()) == 0
    assert met[0, 3] == 1


def test_many_meetings_are_counted_as_few_are(monkeypatch: pytest.MonkeyPatch) -> None:
    games = pair_up(tuple(range(30)), 7, 4)
    listed = count_meetings(games, 30)

    monkeypatch.setattr("wildscav_evaluator.tournaments.meetings.MANY_CELLS", 0)

    assert (count_meetings(games, 30) == listed).all()


def test_draws_are_philox_and_stay_what_they_are() -> None:
    draws = Draws("a", 1)

    assert draws.words(2).tolist() == [18060064335630236126, 1650220348908585770]
    assert sorted(draws.order(6).tolist()) == list(range(6))
