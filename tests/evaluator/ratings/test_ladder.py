"""The running ladder: what a match does to the skills of those who played it."""

import itertools
import math

import numpy as np
import pytest
from tests.evaluator.ratings.simulated_tournaments import simulated_tournament

from wildscav_evaluator.ratings.ladder import SCALE, Ladder, Skill, information, ladder
from wildscav_evaluator.ratings.matches import RatedMatch


def match(*places: int) -> RatedMatch:
    """Return a match of entrants a, b, c and so on with these places."""
    return RatedMatch(0, tuple((chr(ord("a") + index),) for index in range(len(places))), places)


def test_a_first_victory_by_weng_and_lins_formulas() -> None:
    # Both start with mu 25 and sigma 25/3; before a match, sigma² grows by (25/300)².
    variance = (25 / 3) ** 2 + (25 / 300) ** 2
    c = math.sqrt(2 * variance + 2 * (25 / 6) ** 2)
    sigma = math.sqrt(variance * (1 - math.sqrt(variance) / c * variance / c**2 / 4))

    after = Ladder().apply(match(1, 2))

    assert after["a"].mu == pytest.approx(25 + variance / c / 2, abs=1e-6)
    assert after["b"].mu == pytest.approx(25 - variance / c / 2, abs=1e-6)
    assert after["a"].sigma == after["b"].sigma == pytest.approx(sigma, abs=1e-6)


def test_a_tie_of_equals_changes_no_mean_but_what_is_known() -> None:
    after = Ladder().apply(match(1, 1, 1))

    assert {skill.mu for skill in after.values()} == {25.0}
    assert all(skill.sigma < 25 / 3 for skill in after.values())


def test_a_tie_moves_unequals_towards_each_other() -> None:
    after = Ladder({"a": Skill(30.0, 4.0)}).apply(match(1, 1))

    assert after["a"].mu < 30.0
    assert after["b"].mu > 25.0


def test_teammates_move_together_by_how_little_each_is_known() -> None:
    teams = RatedMatch(0, (("a", "b"), ("c", "d")), (2, 1))
    after = Ladder({"a": Skill(25.0, 2.0)}).apply(teams)

    assert after["b"].mu < after["a"].mu < 25.0 < after["c"].mu == after["d"].mu


def test_a_place_among_many_counts_as_few_comparisons() -> None:
    assert information(2) == 1.0
    # Harmonic numbers of 4 and 8: 25/12 and 761/280.
    assert information(4) * 3 == pytest.approx(4 - 25 / 12)
    assert information(8) * 7 == pytest.approx((8 - 761 / 280) / 2)
    assert all(information(teams) * (teams - 1) < 4 for teams in (16, 64, 1000))


def test_one_match_of_32_does_not_settle_everything() -> None:
    after = Ladder().apply(RatedMatch(0, tuple((str(i),) for i in range(32)), tuple(range(1, 33))))

    assert all(6.0 < skill.sigma < 8.0 for skill in after.values())
    assert 10.0 < after["31"].mu < 25.0 < after["0"].mu < 40.0


@pytest.mark.parametrize("seats", [2, 4, 16])
def test_entrants_of_known_strength_come_out_in_their_order(seats: int) -> None:
    strengths = [2.5 - index * (5.0 / 15) for index in range(16)]
    matches = simulated_tournament(strengths, seed=1, games=800 // seats, seats=seats, repeats=2)

    final = [steps[-1].skill.mu for steps in ladder(matches).values()]

    assert np.corrcoef(final, strengths)[0, 1] > 0.93


def test_a_ladder_continues_from_stored_skills_as_if_it_had_never_stopped() -> None:
    matches = simulated_tournament([1.0, 0.5, 0.0, -0.5, -1.0], seed=2, games=20)
    whole = ladder(matches)
    first = {name: steps[-1].skill for name, steps in ladder(matches[:37]).items()}

    rest = ladder(matches[37:], start=first)

    assert {name: steps[-1].skill for name, steps in rest.items()} == {
        name: steps[-1].skill for name, steps in whole.items()
    }


def test_the_history_names_the_match_after_which_a_skill_was_reached() -> None:
    duels = [RatedMatch(0, pair, (1, 2)) for pair in [(("a",), ("b",)), (("c",), ("a",)), (("a",), ("b",))]]
    history = ladder(duels)

    assert [step.match for step in history["a"]] == [0, 1, 2]
    assert [step.match for step in history["c"]] == [1]
    assert list(history) == ["a", "b", "c"]
    assert history["a"][0].skill == Ladder().apply(duels[0])["a"]


def test_the_order_of_the_teams_within_a_match_does_not_matter() -> None:
    start = {"a": Skill(31.0, 2.0), "b": Skill(22.0, 5.0)}
    results = []
    for order in itertools.permutations([(("a",), 1), (("b",), 2), (("c", "d"), 2)]):
        teams, places = zip(*order, strict=True)
        results.append(dict(Ladder(start).apply(RatedMatch(0, teams, places))))

    assert all(result == results[0] for result in results)


def test_the_rating_shown() -> None:
    assert (Skill().rating, round(Skill().deviation, 1)) == (1500.0, 245.7)
    # 400 points more are odds of 10 : 1 between entrants that are well known.
    ahead = Skill(25.0 + 400.0 / SCALE)
    assert math.exp((ahead.mu - 25.0) / (math.sqrt(2) * 25 / 6)) == pytest.approx(10.0)
