"""The fit of all matches at once: what ratings follow from which results."""

import math
import random
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import optimize
from scipy.special import expit
from tests.evaluator.ratings.simulated_tournaments import simulated_tournament

from wildscav.errors import WildscavError
from wildscav_evaluator.ratings.fit import ELO, compare_entrants, fit
from wildscav_evaluator.ratings.matches import RatedMatch, pairings

NAMES = "abcdef"


def duels(results: Sequence[str], start: int = 0) -> list[RatedMatch]:
    """Return a match for each text, such as "a>b" or "a=b", each a game of its own."""
    return [
        RatedMatch(game, ((text[0],), (text[2],)), (1, 2 if text[1] == ">" else 1))
        for game, text in enumerate(results, start)
    ]


def ratings(matches: Sequence[RatedMatch]) -> dict[str, float]:
    found = fit(matches)
    return dict(zip(found.names, found.ratings.tolist(), strict=True))


def test_two_entrants_of_whom_one_wins_twice_as_often() -> None:
    found = ratings(duels(["a>b", "a>b", "b>a"] * 10))

    # 20 points of 30, and half a point of the imaginary tie, against an opponent half as far away.
    margin = (found["a"] - found["b"]) / ELO
    assert 30 * expit(margin) + expit(margin / 2) == pytest.approx(20.5)
    assert found["a"] + found["b"] == pytest.approx(3000.0)


def test_a_tie_is_half_a_win_for_each() -> None:
    tied, shared = duels(["a>b", "a=b", "a=b"] * 5), duels(["a>b", "a>b", "b>a"] * 5)

    assert ratings(tied) == pytest.approx(ratings(shared))


def test_undefeated_and_winless_entrants_have_finite_ratings_in_their_order() -> None:
    found = ratings(duels(["a>b", "a>c", "b>c"] * 8))

    assert all(math.isfinite(rating) for rating in found.values())
    assert 400 < found["a"] - found["b"] < 1200
    assert found["b"] == pytest.approx(1500.0)
    assert found["a"] + found["c"] == pytest.approx(3000.0)
    assert ratings(duels(["a>b"] * 20))["a"] > ratings(duels(["a>b"] * 5))["a"]
    low, high = fit(duels(["a>b"] * 6)).interval("a") or (0.0, 0.0)
    assert high - low > 300.0, "it is not known exactly"


def test_entrants_who_never_met_are_in_groups_of_their_own() -> None:
    found = fit(duels(["x>y", "x>y", "a>b", "b>c"]))

    groups = dict(zip(found.names, found.groups.tolist(), strict=True))
    assert groups == {"a": 0, "b": 0, "c": 0, "x": 1, "y": 1}  # the largest group first
    both = ratings(duels(["x>y", "x>y", "a>b", "b>c"]))
    assert both["x"] + both["y"] == pytest.approx(3000.0)
    assert both["a"] + both["b"] + both["c"] == pytest.approx(4500.0)
    assert both["x"] == pytest.approx(ratings(duels(["x>y", "x>y"]))["x"])  # others do not change it


def test_a_single_game_has_no_interval() -> None:
    found = fit(duels(["a>b"]))

    assert found.interval("a") is None
    assert found.ratings[0] > 1500.0 > found.ratings[1]


def test_repeats_of_one_game_do_not_make_an_interval_narrower() -> None:
    results = ["a>b", "b>a", "a>b", "a>b", "b>a", "a>b", "b>a", "a>b"]
    once = duels(results)
    repeated = [match for match in once for _ in range(20)]  # the same result in each of 20 repeats
    apart = [RatedMatch(game, one.teams, one.places) for game, one in enumerate(repeated)]

    def width(matches: Sequence[RatedMatch]) -> float:
        low, high = fit(matches).interval("a") or (0.0, 0.0)
        return high - low

    assert width(repeated) > 0.9 * width(once)
    assert width(apart) < 0.3 * width(once)


def test_a_match_of_teams_compares_each_member_with_each_opponent() -> None:
    teams = [RatedMatch(game, (("a", "b"), ("c", "d")), (1, 2)) for game in range(6)]
    pairs = [
        RatedMatch(game, ((one.first,), (one.second,)), (1, 2))
        for game in range(6)
        for one in pairings(teams[game])
    ]

    assert ratings(teams) == pytest.approx(ratings(pairs))


def test_there_must_be_a_match() -> None:
    with pytest.raises(ValueError, match="no matches"):
        fit([])


def test_ratings_that_do_not_converge_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wildscav_evaluator.ratings.fit.MAX_ITERATIONS", 2)
    with pytest.raises(WildscavError, match="do not converge within 2 iterations"):
        fit(duels(["a>b"] * 20))


def test_the_ratings_are_those_of_an_independent_maximization_of_the_likelihood() -> None:
    matches = simulated_tournament([2.0, 1.0, 0.5, 0.0, -1.0, -3.0], seed=3, games=30)
    found = compare_entrants(matches)

    def cost(strengths: np.ndarray) -> float:
        margins = strengths[found.first] - strengths[found.second]
        likelihood = found.points * margins - np.logaddexp(0.0, margins)
        ties = 0.5 * strengths - np.logaddexp(0.0, strengths)
        return -float(likelihood.sum() + ties.sum())

    best = optimize.minimize(cost, np.zeros(6), method="BFGS", options={"gtol": 1e-6}).x
    assert fit(matches).ratings == pytest.approx(1500.0 + ELO * (best - best.mean()), abs=0.01)


def test_95_of_100_intervals_contain_the_true_rating() -> None:
    strengths = np.array([1.5, 1.0, 0.3, 0.0, -0.5, -2.0])
    true = 1500.0 + ELO * (strengths - strengths.mean())
    contained = []
    for seed in range(60):
        found = fit(simulated_tournament(strengths.tolist(), seed, games=30, repeats=2, luck=0.0))
        intervals = [found.interval(name) or (0.0, 0.0) for name in found.names]
        contained += [low <= rating <= high for (low, high), rating in zip(intervals, true, strict=True)]

    # Of 360, within three standard errors of a proportion: 0.95 ± 0.035.
    assert 0.915 <= np.mean(contained) <= 0.985


MATCHES = st.lists(
    st.builds(
        lambda game, names, places: RatedMatch(
            game, tuple((name,) for name in names), tuple(places[: len(names)])
        ),
        st.integers(0, 5),
        st.lists(st.sampled_from(NAMES), min_size=2, max_size=4, unique=True),
        st.lists(st.integers(1, 4), min_size=4, max_size=4),
    ),
    min_size=1,
    max_size=20,
)


@given(MATCHES, st.randoms(use_true_random=False))
def test_the_order_of_the_matches_does_not_matter_to_the_last_bit(
    matches: list[RatedMatch], order: random.Random
) -> None:
    before = fit(matches)
    shuffled = order.sample(matches, len(matches))
    after = fit(shuffled)

    assert before.names == after.names
    assert before.ratings.tobytes() == after.ratings.tobytes()
    assert before.covariance.tobytes() == after.covariance.tobytes()


@given(MATCHES, st.permutations(NAMES))
def test_other_names_change_no_rating(matches: list[RatedMatch], others: list[str]) -> None:
    renamed = dict(zip(NAMES, others, strict=True))
    before = ratings(matches)
    after = ratings(
        [
            RatedMatch(one.game, tuple((renamed[name],) for (name,) in one.teams), one.places)
            for one in matches
        ]
    )

    assert {renamed[name]: rating for name, rating in before.items()} == pytest.approx(after, abs=1e-6)
