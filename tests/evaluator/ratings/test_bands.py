"""Who can be told apart, checked on simulated tournaments of entrants whose strength is known."""

import numpy as np
import pytest
from tests.evaluator.ratings.simulated_tournaments import simulated_tournament

from wildscav_evaluator.ratings.bands import rank_entrants, significantly_better
from wildscav_evaluator.ratings.fit import fit
from wildscav_evaluator.ratings.matches import RatedMatch

TOURNAMENTS = 100
# If 5 % of tournaments separate identical entrants, more than 11 of 100 do so with a probability of 0.4 %.
MAX_SEPARATED = 11
DISTINCT = [2.1, 1.4, 0.7, 0.0, -0.7, -1.4, -2.1, -2.8]


def chain(games: int, *names: str) -> list[RatedMatch]:
    """Return matches in which each name is always placed in front of those after it."""
    return [
        RatedMatch(game, tuple((name,) for name in names), tuple(range(1, len(names) + 1)))
        for game in range(games)
    ]


@pytest.mark.slow
def test_no_two_of_eight_identical_entrants_are_told_apart_in_95_of_100_tournaments() -> None:
    separated = 0
    for seed in range(TOURNAMENTS):
        found = fit(simulated_tournament([0.0] * 8, seed, games=30, repeats=2))
        separated += significantly_better(found).any()

    assert separated <= MAX_SEPARATED


@pytest.mark.parametrize("games", [6, 12])
def test_one_of_two_identical_entrants_rarely_wins_a_short_tournament(games: int) -> None:
    separated = 0
    for seed in range(TOURNAMENTS):
        found = fit(simulated_tournament([0.0, 0.0], seed, games=games, seats=2, repeats=2, luck=1.0))
        separated += significantly_better(found).any()

    assert separated <= MAX_SEPARATED


def test_eight_different_entrants_come_out_in_their_order_and_most_are_told_apart() -> None:
    told_apart, in_order = [], 0
    for seed in range(20):
        found = fit(simulated_tournament(DISTINCT, seed, games=100))
        better = significantly_better(found)
        assert not np.tril(better).any(), "a weaker entrant is significantly better"
        told_apart.append(better[np.triu_indices(8, 1)].mean())
        in_order += rank_entrants(found).names == found.names

    assert np.mean(told_apart) > 0.8
    assert in_order >= 18


def test_ranks_and_bands_of_entrants_who_always_come_in_one_order() -> None:
    ranking = rank_entrants(fit(chain(30, "c", "a", "b")))

    assert ranking.names == ("c", "a", "b")
    assert ranking.ranks == {"c": (1, 1), "a": (2, 2), "b": (3, 3)}
    assert ranking.bands == (("c",), ("a",), ("b",))


def test_all_have_rank_one_where_no_one_is_better() -> None:
    ranking = rank_entrants(fit([*chain(10, "a", "b"), *chain(10, "b", "a")]))

    assert ranking.ranks == {"a": (1, 2), "b": (1, 2)}
    assert ranking.bands == (("a", "b"),)


@pytest.mark.parametrize(("games", "told_apart"), [(1, False), (5, False), (6, True)])
def test_fewer_than_six_games_tell_nobody_apart(games: int, told_apart: bool) -> None:
    # One of two identical entrants wins all of 5 games with a probability of 6 %, and all of 6 with one of
    # 3 %.
    better = significantly_better(fit(chain(games, "a", "b")))

    assert better.any() == told_apart


def test_the_middle_of_three_may_be_in_two_bands() -> None:
    # a beats c; b cannot be told from either.
    matches = [
        *chain(12, "a", "c"),
        *(RatedMatch(20 + game, (("a",), ("b",)), (1 + game % 2, 2 - game % 2)) for game in range(6)),
        *(RatedMatch(40 + game, (("b",), ("c",)), (1 + game % 2, 2 - game % 2)) for game in range(6)),
    ]
    ranking = rank_entrants(fit(matches))

    assert ranking.bands == (("a", "b"), ("b", "c"))
    assert ranking.ranks == {"a": (1, 2), "b": (1, 3), "c": (2, 3)}


def test_entrants_who_never_met_are_not_ranked_against_each_other() -> None:
    others = [RatedMatch(game + 50, (("x",), ("y",)), (1, 2)) for game in range(30)]
    ranking = rank_entrants(fit([*chain(30, "a", "b", "c"), *others]))

    assert ranking.names == ("a", "b", "c", "x", "y")
    assert ranking.ranks["x"] == (1, 1)
    assert ranking.ranks["y"] == (2, 2)
    assert ranking.bands == (("a",), ("b",), ("c",), ("x",), ("y",))
